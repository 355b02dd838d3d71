// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/internal/convex_polygon.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lamina {

// Source: [Andrew1979], two chains over points in order of x.
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  std::ranges::sort(points, [](Vec2 a, Vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vec2> hull;
  const auto add = [&](Vec2 p, std::size_t least) {
    while (hull.size() >= least && turn(hull[hull.size() - 2], hull.back(), p) <= 0.0)
      hull.pop_back();
    hull.push_back(p);
  };
  for (const Vec2 p : points) add(p, 2);
  const std::size_t upper = hull.size() + 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], upper);
  hull.pop_back();
  return hull;
}

double polygon_area(std::span<const Vec2> corners) {
  double twice = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 a = corners[i], b = corners[(i + 1) % corners.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5 * twice;
}

std::optional<std::array<Vec2, 4>> four_corners(std::vector<Vec2> hull) {
  if (hull.size() < 4) return std::nullopt;
  const auto area_of = [&](std::size_t i) {
    const std::size_t n = hull.size();
    return std::abs(turn(hull[(i + n - 1) % n], hull[i], hull[(i + 1) % n]));
  };
  while (hull.size() > 4) {
    std::size_t least = 0;
    for (std::size_t i = 1; i < hull.size(); ++i)
      if (area_of(i) < area_of(least)) least = i;
    hull.erase(hull.begin() + static_cast<std::ptrdiff_t>(least));
  }
  return std::array{hull[0], hull[1], hull[2], hull[3]};
}

}  // namespace lamina
