// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/blurs/gaussian_blurs.h"
#include "lamina/solve/scattering/heterogeneous/path_absorption.h"

namespace lamina::detail {

/// Weights of the scales of a pyramid for absorption along paths.
/// @param decay_length  [texel]
[[nodiscard]] inline std::vector<double> path_scales(const BlurPyramid& pyramid,
                                                     double decay_length) {
  std::array<std::vector<double>, 2> scales;
  for (std::size_t i = 0; i < 2; ++i)
    scales[i] = scales_of_gaussians(pyramid, std::array{path_variances(decay_length)[i]});
  return sum_by_shares(scales);
}

/// How they change with the logarithm of the length.
[[nodiscard]] inline std::vector<double> path_scale_slopes(const BlurPyramid& pyramid,
                                                           double decay_length) {
  std::array<std::vector<double>, 2> slopes;
  for (std::size_t i = 0; i < 2; ++i) {
    const double variance = path_variances(decay_length)[i];
    slopes[i] = scale_slopes(pyramid, variance);
    for (double& slope : slopes[i]) slope *= 2.0 * variance;
  }
  return sum_by_shares(slopes);
}

/// Calls `take(one, other)` with each two texels side by side.
template <class Take>
void for_plane_neighbors(int width, int height, const Take& take) {
  const auto row = static_cast<std::size_t>(width);
  const std::size_t size = row * static_cast<std::size_t>(height);
  for (std::size_t i = 0; i < size; ++i) {
    if ((i + 1) % row != 0) take(i, i + 1);
    if (i + row < size) take(i, i + row);
  }
}

}  // namespace lamina::detail
