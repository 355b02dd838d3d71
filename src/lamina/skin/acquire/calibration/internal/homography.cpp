// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/internal/homography.h"

#include <cmath>
#include <cstddef>

#include "lamina/base/core/dense_matrix.h"

namespace lamina {

Vec2 seen_at(const Matrix3& h, Vec2 p) {
  const std::array<double, 3> v = h * std::array<double, 3>{p.x, p.y, 1.0};
  return {v[0] / v[2], v[1] / v[2]};
}

// Places are measured from their middle in units of their scatter, which keeps the equations well
// conditioned; there the last entry cannot vanish.
Matrix3 fit_homography(std::span<const Vec2> plane, std::span<const Vec2> picture) {
  Vec2 middle{};
  for (const Vec2 p : picture) middle = middle + (1.0 / static_cast<double>(picture.size())) * p;
  double scatter = 0.0;
  for (const Vec2 p : picture)
    scatter += std::hypot(p.x - middle.x, p.y - middle.y) / static_cast<double>(picture.size());
  DenseMatrix a(2 * plane.size(), 8), b(2 * plane.size(), 1);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const Vec2 from = plane[i], to = (1.0 / scatter) * (picture[i] - middle);
    const double rows[2][8] = {{from.x, from.y, 1, 0, 0, 0, -to.x * from.x, -to.x * from.y},
                               {0, 0, 0, from.x, from.y, 1, -to.y * from.x, -to.y * from.y}};
    for (std::size_t r = 0; r < 2; ++r) {
      for (std::size_t c = 0; c < 8; ++c) a(2 * i + r, c) = rows[r][c];
      b(2 * i + r, 0) = r == 0 ? to.x : to.y;
    }
  }
  const DenseMatrix x = solve_least_squares(a, b);
  const Matrix3 normalized = {
      {{x(0, 0), x(1, 0), x(2, 0)}, {x(3, 0), x(4, 0), x(5, 0)}, {x(6, 0), x(7, 0), 1.0}}};
  const Matrix3 back = {{{scatter, 0, middle.x}, {0, scatter, middle.y}, {0, 0, 1}}};
  return back * normalized;
}

}  // namespace lamina
