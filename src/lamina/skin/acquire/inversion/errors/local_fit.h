// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/skin/acquire/inversion/errors/posterior.h"

namespace lamina::detail {

/// The light that arrives at each texel, [image], by which what uniform skin reflects is to be
/// multiplied to get what the patch shows: that with which skin that is uniform, as the reference
/// of the tables is, comes out right. Without transport the light as it is.
[[nodiscard]] TexelMaps light_levels(const PatchObjective& objective);

/// Coordinates of each texel as if its surroundings were like it; where nothing is known, smooth
/// between those around.
///
/// @param level  as light_levels gives it
[[nodiscard]] TexelMaps fit_texels(const PatchObjective& objective, const TexelMaps& level,
                                   double robust_limit);

/// Misfit of such fits to each image, of some of the texels evenly spread over those that are
/// known.
[[nodiscard]] std::vector<BandMisfit> texel_misfit(const PatchObjective& objective,
                                                   const TexelMaps& level, double robust_limit);

/// Errors of these fits.
[[nodiscard]] PosteriorErrors texel_errors(const PatchObjective& objective, const TexelMaps& level,
                                           const TexelMaps& coordinates, double robust_limit);

/// Images of skin of these coordinates if light does not travel sideways.
[[nodiscard]] TexelMaps local_images(const PatchObjective& objective, const TexelMaps& level,
                                     const TexelMaps& coordinates);

}  // namespace lamina::detail
