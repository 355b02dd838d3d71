// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lamina/skin/maps/skin_features.h"

namespace lamina {

struct CanvasPoint {
  double x, y;
};

/// The texels of the maps.
struct CanvasGrid {
  int width, height;
  double mm;  ///< per texel

  [[nodiscard]] double across() const { return width * mm; }
  [[nodiscard]] double down() const { return height * mm; }
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }

  /// Calls `act(index, place)` for the texels of a square.
  template <class Act>
  void within(CanvasPoint middle, double half_side, const Act& act) const {
    const auto first = [&](double at) { return std::max(0, static_cast<int>(at / mm - 0.5)); };
    const auto last = [&](double at, int size) {
      return std::min(size, static_cast<int>(std::ceil(at / mm + 0.5)));
    };
    for (int y = first(middle.y - half_side); y < last(middle.y + half_side, height); ++y)
      for (int x = first(middle.x - half_side); x < last(middle.x + half_side, width); ++x)
        act(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(x),
            CanvasPoint{(x + 0.5) * mm, (y + 0.5) * mm});
  }
  template <class Act>
  void everywhere(const Act& act) const {
    within({0.5 * across(), 0.5 * down()}, std::max(across(), down()), act);
  }
};

/// The skin of each texel while features change it.
struct SkinCanvas {
  CanvasGrid grid;
  std::vector<SkinParameters> skin;
};

/// Spreads the maps of an example over the canvas.
void apply_feature(const Synthesis& synthesis, std::uint64_t seed, SkinCanvas& canvas);

}  // namespace lamina
