// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/solve/scattering/low_orders/single_scattering_profile.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"

namespace lamina::detail {

/// A way of light through the stack without scattering, known by what it meets.
struct UnscatteredPath {
  std::vector<int> passes;     ///< [layer] how often it goes through
  std::vector<int> crossings;  ///< [interface] how often refracted there
  std::vector<int> mirrors;    ///< [interface] how often reflected there
  int count = 1;               ///< ways that meet the same
  bool is_up = false;          ///< whether it ends above
};

/// All ways from above with at most so many reflections that carry more than 1e-7 of the light;
/// none of them by a rough top.
[[nodiscard]] std::vector<UnscatteredPath> unscattered_paths(const GridStack& stack,
                                                             int most_mirrors = 3);

/// Diffuse light from above on one point, or a beam that a rough top spreads, that leaves along
/// these paths, over its flux; what the top surface mirrors is not among them. At spatial frequency
/// k, with the azimuthal modes of the solver.
[[nodiscard]] FrequencyResponse unscattered_response(const FrequencySolver& solver,
                                                     const std::vector<UnscatteredPath>& paths,
                                                     double k);

/// Mean of unscattered light between two distances [mm] from that point [1/mm²]: where light ends
/// at a radius, or crowds before it, radii of a grid miss it.
[[nodiscard]] SingleScatteringProfile unscattered_ring(const FrequencySolver& solver,
                                                       const std::vector<UnscatteredPath>& paths,
                                                       double begin, double end);

}  // namespace lamina::detail
