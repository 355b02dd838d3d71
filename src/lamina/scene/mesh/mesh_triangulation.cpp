// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/mesh_triangulation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace lamina {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Vec3 doubled_area(const Vec3& a, const Vec3& b, const Vec3& c) { return cross(b - a, c - a); }

Triangles fan(std::uint32_t count) {
  Triangles triangles;
  for (std::uint32_t i = 1; i + 1 < count; ++i) triangles.push_back({0, i, i + 1});
  return triangles;
}

Triangles cut_quadrilateral(std::span<const Vec3> p) {
  const auto agree = [&](std::size_t a) {  // the two triangles on both sides of the diagonal from a
    const std::size_t b = (a + 1) % 4, c = (a + 2) % 4, d = (a + 3) % 4;
    return dot(doubled_area(p[a], p[b], p[c]), doubled_area(p[a], p[c], p[d])) > 0.0;
  };
  const Vec3 d02 = p[2] - p[0], d13 = p[3] - p[1];
  const bool is_first_good = agree(0), is_second_good = agree(1);
  const bool use_first =
      is_first_good != is_second_good ? is_first_good : dot(d02, d02) <= dot(d13, d13);
  if (use_first) return {{0, 1, 2}, {0, 2, 3}};
  return {{0, 1, 3}, {1, 2, 3}};
}

/// Cuts off, again and again, the corner of the best shape among those whose triangle holds no
/// other corner. Source: [Meisters1975]; where rounding or crossing edges leave no such corner, any
/// goes.
class EarClipper {
 public:
  EarClipper(std::span<const Vec3> points, const Vec3& normal) : left_(points.size()) {
    // Drop the axis along which the polygon is thinnest; mirror if the normal points down it.
    int axis = 0;
    for (int a = 1; a < 3; ++a)
      if (std::abs(normal[a]) > std::abs(normal[axis])) axis = a;
    for (const Vec3& p : points) {
      Vec2 q{p[(axis + 1) % 3], p[(axis + 2) % 3]};
      if (normal[axis] < 0.0) q.x = -q.x;
      flat_.push_back(q);
    }
    std::iota(left_.begin(), left_.end(), 0U);
    for (std::size_t i = 0; i < left_.size(); ++i) quality_.push_back(ear_quality(i));
  }

  Triangles run() {
    Triangles triangles;
    while (left_.size() > 3) {
      std::size_t best = 0;
      double best_quality = -1.0;
      for (std::size_t i = 0; i < left_.size(); ++i) {
        if (quality_[i] > best_quality) best = i, best_quality = quality_[i];
        if (quality_[i] > 0.2) break;  // good enough
      }
      triangles.push_back(triangle_at(best));
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(best));
      quality_.erase(quality_.begin() + static_cast<std::ptrdiff_t>(best));
      // Where polygons do not cross themselves, only the neighbours of an ear change with it.
      const std::size_t count = left_.size();
      for (const std::size_t i : {best % count, (best + count - 1) % count})
        quality_[i] = ear_quality(i);
    }
    triangles.push_back({left_[0], left_[1], left_[2]});
    return triangles;
  }

 private:
  [[nodiscard]] std::array<std::uint32_t, 3> triangle_at(std::size_t i) const {
    return {left_[(i + left_.size() - 1) % left_.size()], left_[i], left_[(i + 1) % left_.size()]};
  }

  [[nodiscard]] double turn(const Vec2& a, const Vec2& b, const Vec2& c) const {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }

  /// Negative if cutting the corner off would be wrong; else area over squared edges, at most 0.29.
  [[nodiscard]] double ear_quality(std::size_t i) const {
    const auto [ia, ib, ic] = triangle_at(i);
    const Vec2 &a = flat_[ia], &b = flat_[ib], &c = flat_[ic];
    const double area = turn(a, b, c);
    if (!(area > 0.0)) return -1.0;
    for (const std::uint32_t other : left_) {
      const Vec2& p = flat_[other];
      if (p == a || p == b || p == c) continue;
      if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return -1.0;
    }
    const auto square = [](const Vec2& v) { return v.x * v.x + v.y * v.y; };
    return area / (square(b - a) + square(c - b) + square(a - c));
  }

  std::vector<Vec2> flat_;
  std::vector<std::uint32_t> left_;
  std::vector<double> quality_;  // [left]
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const Vec3> points) {
  assert(points.size() >= 3);
  if (points.size() == 3) return {{0, 1, 2}};
  if (points.size() == 4) return cut_quadrilateral(points);
  constexpr std::size_t most_clipped = 2000;
  if (points.size() > most_clipped) return fan(static_cast<std::uint32_t>(points.size()));
  Vec3 normal;
  for (std::size_t i = 1; i + 1 < points.size(); ++i)
    normal += doubled_area(points[0], points[i], points[i + 1]);
  return EarClipper(points, normal).run();
}

}  // namespace lamina
