// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/skin/fit/measured/measurement.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/adding_doubling_derivatives.h"

namespace lamina::fit_detail {

/// Totals that ports of spheres do not collect: of the beam, and of the diffuse light of the
/// spheres.
struct LostTotals {
  double reflected = 0.0, transmitted = 0.0;
  double diffuse_above = 0.0, diffuse_below = 0.0;
};

/// By photons, more for smaller errors of the points; nothing is lost of a series without beam
/// diameter.
[[nodiscard]] LostTotals lost_totals(const LayerStack& stack, const MeasuredSeries& series,
                                     std::span<const MeasuredPoint> points);

/// Reading of the sphere of a point.
struct SphereTotal {
  double value = 0.0;
  std::vector<LayerDerivatives> derivatives;  ///< [layer], if the totals have them
};

/// @param beam     totals of the beam
/// @param diffuse  of diffuse light from the side of the sphere; of that below, of the stack turned
///                 over
[[nodiscard]] SphereTotal sphere_total(const MeasuredPoint& point, bool has_specular,
                                       const AddingDoublingDerivatives& beam,
                                       const AddingDoublingDerivatives& diffuse,
                                       const LostTotals& lost);

}  // namespace lamina::fit_detail
