// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/spectrum/rgb_space.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

Xyz white_of(const Matrix3& to_xyz) { return to_xyz * std::array<double, 3>{1, 1, 1}; }

}  // namespace

RgbPrimaries primaries_of(RgbSpace space) {
  if (space == RgbSpace::acescg)
    return {{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};
  return rec709_primaries();
}

RgbPrimaries aces2065_primaries() {
  return {{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.077}, {0.32168, 0.33767}};
}

bool are_alike(const RgbPrimaries& a, const RgbPrimaries& b) {
  const auto near = [](const RgbPrimaries::Xy& p, const RgbPrimaries::Xy& q) {
    return std::abs(p[0] - q[0]) <= 1e-4 && std::abs(p[1] - q[1]) <= 1e-4;
  };
  return near(a.red, b.red) && near(a.green, b.green) && near(a.blue, b.blue) &&
         near(a.white, b.white);
}

Matrix3 rgb_conversion(const RgbPrimaries& from, const RgbPrimaries& to) {
  const Matrix3 in = rgb_to_xyz(from), out = rgb_to_xyz(to);
  const Matrix3 conversion = inverse(out) * bradford_adaptation(white_of(in), white_of(out)) * in;
  for (const auto& row : conversion)
    for (const double value : row)
      if (!std::isfinite(value)) throw InvalidInput("primaries of RGB: their white is no light");
  return conversion;
}

}  // namespace lamina
