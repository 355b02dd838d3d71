// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

/// Thickness of an absorbing sheet, a film that has none [mm]: light goes a nanometre to the side.
inline constexpr double sheet_thickness = 1e-6;

/// A film that absorbs and has no thickness that counts, as a layer that does not scatter.
///
/// @param optical_density  -log10 of what it lets through along the normal, >= 0. Aslant, at the
///                         angle theta inside, its 1 / cos(theta)-th power passes.
/// @param ior              > 0; that of the layer on whose side of a boundary the film lies.
[[nodiscard]] inline Layer absorbing_sheet(double optical_density, double ior) {
  return {.medium = {.sigma_a = optical_density * std::numbers::ln10 / sheet_thickness, .ior = ior},
          .thickness = sheet_thickness};
}

/// Whether a layer is one. At 90 degrees less 1e-6 it would shift light by a millimetre.
[[nodiscard]] inline bool is_sheet(const Layer& layer) {
  return layer.medium.sigma_s == 0.0 && layer.thickness <= sheet_thickness;
}

}  // namespace lamina
