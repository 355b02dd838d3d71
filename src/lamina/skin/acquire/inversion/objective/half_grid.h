// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace lamina::detail {

/// A grid of texels, and the one of half its width and height, rounded up.
struct GridSize {
  int width = 0, height = 0;
  [[nodiscard]] GridSize half() const { return {(width + 1) / 2, (height + 1) / 2}; }
  [[nodiscard]] std::size_t texels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

/// Calls take(fine texel, coarse texel, weight) for the bilinear weights between a grid and its
/// half: those of a fine texel sum to 1.
template <class Take>
void for_bilinear(const GridSize& fine, const Take& take) {
  const GridSize coarse = fine.half();
  const auto far = [](int at, int size) {
    return std::clamp(at % 2 == 0 ? at / 2 - 1 : at / 2 + 1, 0, size - 1);
  };
  const auto place = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(coarse.width) +
           static_cast<std::size_t>(x);
  };
  std::size_t t = 0;
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x, ++t) {
      const int far_x = far(x, coarse.width), far_y = far(y, coarse.height);
      take(t, place(x / 2, y / 2), 0.5625f);
      take(t, place(far_x, y / 2), 0.1875f);
      take(t, place(x / 2, far_y), 0.1875f);
      take(t, place(far_x, far_y), 0.0625f);
    }
}

/// A map of the half grid on the fine one.
[[nodiscard]] inline std::vector<float> on_fine(const GridSize& fine,
                                                const std::vector<float>& coarse) {
  std::vector<float> result(fine.texels(), 0.0f);
  for_bilinear(
      fine, [&](std::size_t t, std::size_t c, float weight) { result[t] += weight * coarse[c]; });
  return result;
}

/// The transpose of on_fine, over 4: about the mean of four texels.
[[nodiscard]] inline std::vector<float> on_half(const GridSize& fine,
                                                const std::vector<float>& map) {
  std::vector<float> result(fine.half().texels(), 0.0f);
  for_bilinear(fine, [&](std::size_t t, std::size_t c, float weight) {
    result[c] += 0.25f * weight * map[t];
  });
  return result;
}

/// Detail band of a map: the waves of its grid, and nothing that is longer.
[[nodiscard]] inline std::vector<float> details(const GridSize& fine,
                                                const std::vector<float>& map) {
  std::vector<float> result = on_fine(fine, on_half(fine, map));
  for (std::size_t t = 0; t < map.size(); ++t) result[t] = map[t] - result[t];
  return result;
}

/// Calls take(texel, its neighbor) for each two texels side by side.
template <class Take>
void for_neighbors(int width, int height, const Take& take) {
  const auto row = static_cast<std::size_t>(width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y)
    for (std::size_t x = 0; x < row; ++x) {
      const std::size_t t = y * row + x;
      if (x + 1 < row) take(t, t + 1);
      if (y + 1 < static_cast<std::size_t>(height)) take(t, t + row);
    }
}

}  // namespace lamina::detail
