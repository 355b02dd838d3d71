// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "lamina/skin/acquire/inversion/objective/half_grid.h"

namespace lamina::detail {

/// How much one kind of derivative of a map counts.
struct DerivativeWeight {
  double weight = 0.0;
  std::vector<float> share;  ///< of it at each texel; empty: 1 everywhere

  [[nodiscard]] double at(std::size_t texel) const {
    return share.empty() ? weight : weight * static_cast<double>(share[texel]);
  }
};

/// How smooth the map of a number is taken to be: half the sum of squares of its first
/// derivatives, differences of texels side by side, and of its third ones, the same differences of
/// its curvature, each times its weight. Waves of square wave number k² per texel then have
/// precision first k² + third k⁶. Beyond its edges the map goes on as its mirror image.
struct MapSmoothness {
  DerivativeWeight first, third;
};

/// Differences of each texel to all its neighbors, summed.
[[nodiscard]] std::vector<float> curvature(const GridSize& size, const std::vector<float>& map);

/// Sums of squares of the first derivatives of a map between each texel and those after it.
[[nodiscard]] std::vector<float> squared_slopes(const GridSize& size,
                                                const std::vector<float>& map);

/// Twice what a map adds to what is made least.
[[nodiscard]] double roughness(const GridSize& size, const MapSmoothness& smoothness,
                               const std::vector<float>& map);

/// Adds the matrix of second derivatives of that, times a map.
void add_roughness_matrix(const GridSize& size, const MapSmoothness& smoothness,
                          const std::vector<float>& map, std::vector<float>& sum);

/// Noise whose covariance is this matrix.
/// @param sign  gives 1 and -1 at random
template <class Sign>
[[nodiscard]] std::vector<float> roughness_noise(const GridSize& size,
                                                 const MapSmoothness& smoothness,
                                                 const Sign& sign) {
  const auto noise_of = [&](const DerivativeWeight& derivative) {
    std::vector<float> noise(size.texels(), 0.0f);
    for_neighbors(size.width, size.height, [&](std::size_t a, std::size_t b) {
      const float flow = static_cast<float>(std::sqrt(derivative.at(a))) * sign();
      noise[a] += flow;
      noise[b] -= flow;
    });
    return noise;
  };
  std::vector<float> noise = noise_of(smoothness.first);
  if (smoothness.third.weight == 0.0) return noise;
  const std::vector<float> third = curvature(size, noise_of(smoothness.third));
  for (std::size_t t = 0; t < noise.size(); ++t) noise[t] += third[t];
  return noise;
}

}  // namespace lamina::detail
