// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace lamina {

/// Cubic interpolation between the four nearest pixel centres of a row or column.
/// Source: [Keys1981], a = -1/2: exact for parabolas.
struct CubicLookup {
  int first = 0;                        ///< of four neighbours; may lie outside of the image
  std::array<double, 4> weights{};      ///< their sum is 1
  std::array<double, 4> derivatives{};  ///< of the weights by the place [1/pixel]
};

/// @param place  in pixels from the edge of the image; the first centre is at .5
[[nodiscard]] inline CubicLookup cubic_lookup(double place) {
  const double left = std::floor(place - 0.5), t = place - 0.5 - left;
  return {static_cast<int>(left) - 1,
          {t * (-0.5 + t * (1.0 - 0.5 * t)), 1.0 + t * t * (-2.5 + 1.5 * t),
           t * (0.5 + t * (2.0 - 1.5 * t)), t * t * (-0.5 + 0.5 * t)},
          {-0.5 + t * (2.0 - 1.5 * t), t * (-5.0 + 4.5 * t), 0.5 + t * (4.0 - 4.5 * t),
           t * (-1.0 + 1.5 * t)}};
}

}  // namespace lamina
