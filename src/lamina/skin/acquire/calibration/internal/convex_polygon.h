// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "lamina/base/core/vec.h"

namespace lamina {

/// Twice the area to the left of a -> b -> c in a picture whose y grows downward, thus positive if
/// they go clockwise.
[[nodiscard]] inline double turn(Vec2 a, Vec2 b, Vec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The smallest convex polygon around points, clockwise as pictures show it.
[[nodiscard]] std::vector<Vec2> convex_hull(std::vector<Vec2> points);

/// Positive if clockwise as pictures show it.
[[nodiscard]] double polygon_area(std::span<const Vec2> corners);

/// The four corners of a convex polygon: of more, those are left out one by one that take the least
/// area with them. Absent if it has fewer.
[[nodiscard]] std::optional<std::array<Vec2, 4>> four_corners(std::vector<Vec2> hull);

}  // namespace lamina
