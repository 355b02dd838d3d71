// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/profile/hankel.h"
#include "lamina/solve/scattering/spatial_frequency/illumination.h"

namespace lamina::detail {

struct ProfileCurves {
  std::vector<double> reflectance, transmittance;             ///< [i] [1/mm²]
  double total_reflectance = 0.0, total_transmittance = 0.0;  ///< integrals over the plane
};

struct StraightLight {
  int nodes = 24;  ///< that do for diffuse light; a beam that a top of little roughness spreads may
                   ///< want more behind a slab, and fewer show by how much they are wrong
  int modes = 41;  ///< azimuthal, of light scattered once
  int frequencies = 48;
  int depth_nodes = 8;  ///< of a panel of depths, see make_diffuse_single
  int mirrors = 3;      ///< most reflections of what is not scattered
  /// single_at_contact if it is known: it depends on the top and the first layer alone.
  std::optional<double> contact = std::nullopt;
};

/// Lowest orders of diffuse light from above on one point, or of a beam that a rough top spreads:
/// light not scattered or scattered once and otherwise not reflected, over the plan's radii: all
/// that `diffuse_responses` has beyond `unscattered_response` and `diffuse_single_on_grid` comes on
/// top.
///
/// @param on_grid  the same stack on the grid of those, above rough boundaries inside.
/// @param light    straight rays and how often they may be reflected.
[[nodiscard]] ProfileCurves diffuse_lowest_orders(const LayerStack& stack, const GridStack& on_grid,
                                                  Illumination illumination, const HankelPlan& plan,
                                                  const StraightLight& light = {});

}  // namespace lamina::detail
