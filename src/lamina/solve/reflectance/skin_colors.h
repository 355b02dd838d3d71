// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/spectrum/band_color.h"
#include "lamina/layers/materials/skin.h"

namespace lamina {

/// Weights that turn skin seen at a few wavelengths into linear sRGB under D65.
///
/// The weights of make_band_weights know nothing of what they look at, and eight wavelengths miss
/// the two bands of hemoglobin between them: skin comes out 2 % too dark. These are the nearest
/// ones that show 150 uniform skins, of all melanin, blood and oxygen, as 5 nm steps would. Each
/// channel's weights sum to 1: white stays white. Of 3 to 24 bands; else those of
/// make_band_weights.
///
/// @param skin  gives what is not varied: scattering, baseline, thickness.
[[nodiscard]] BandWeights make_skin_band_weights(const BandSet& bands, const SkinParameters& skin);

}  // namespace lamina
