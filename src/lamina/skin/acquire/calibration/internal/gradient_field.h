// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/base/image/image.h"
#include "lamina/skin/acquire/calibration/pixel_mask.h"

namespace lamina {

/// Gradients of one channel over their length, where that is more than their median's double: 1 at
/// edges, near 0 in noise.
struct GradientField {
  int width = 0, height = 0;
  std::vector<Vec2f> gradients;  ///< [y][x]
  std::vector<float> weights;    ///< [y][x] in [0, 1]: how much of it is used

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

/// Fields of an image and of those half, a quarter ... as large, while the shorter side is 32
/// pixels or more. Pixels that are not used count as the median nearby.
[[nodiscard]] std::vector<GradientField> gradient_pyramid(const Image& image, std::size_t channel,
                                                          const PixelMask& mask);

/// A field between its pixels, and its derivatives by the place.
struct GradientSample {
  Vec2 value{}, by_x{}, by_y{};
};

/// @param place  in pixels; two pixels or more from the edges
[[nodiscard]] GradientSample sample_gradient(const GradientField& field, Vec2 place);

}  // namespace lamina
