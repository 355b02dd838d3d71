// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lamina/base/core/vec.h"

namespace lamina {

/// Pixels that hang together, side by side.
struct PixelRegion {
  std::size_t pixels = 0;
  Vec2 centroid{};        ///< of the pixels' centres
  std::vector<Vec2> rim;  ///< corners of the first and last pixel of each row: they have its hull
  bool touches_edge = false;  ///< of the image
};

/// The regions of pixels that are set, [y][x], from the top.
[[nodiscard]] std::vector<PixelRegion> connected_regions(const std::vector<bool>& set, int width,
                                                         int height);

}  // namespace lamina
