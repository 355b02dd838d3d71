// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace lamina {

/// Bilinear interpolation: the four texels around a place in an image, and where it lies between
/// their centres.
template <class Real>
struct BilinearLookup {
  int x0, y0, x1, y1;
  Real fx, fy;  ///< in [0, 1), from the first to the second

  /// @param texel  texel(x, y) is a number or a vector
  template <class Texel>
  [[nodiscard]] auto interpolate(const Texel& texel) const {
    const Real one{1};
    return (one - fy) * ((one - fx) * texel(x0, y0) + fx * texel(x1, y0)) +
           fy * ((one - fx) * texel(x0, y1) + fx * texel(x1, y1));
  }
};

/// An image of width x height texels that repeats; x and y in texels from its upper left corner.
template <class Real>
[[nodiscard]] BilinearLookup<Real> bilinear_repeated(Real x, Real y, int width, int height) {
  const auto wrap = [](int i, int size) {
    const int rest = i % size;
    return rest < 0 ? rest + size : rest;
  };
  x -= Real(0.5);
  y -= Real(0.5);
  const Real left = std::floor(x), top = std::floor(y);
  const int x0 = wrap(static_cast<int>(left), width), y0 = wrap(static_cast<int>(top), height);
  return {x0, y0, x0 + 1 == width ? 0 : x0 + 1, y0 + 1 == height ? 0 : y0 + 1, x - left, y - top};
}

/// Bilinear lookup with the texels of the edge beyond it.
template <class Real>
[[nodiscard]] BilinearLookup<Real> bilinear_clamped(Real x, Real y, int width, int height) {
  const auto clamp = [](Real i, int size) { return std::clamp(static_cast<int>(i), 0, size - 1); };
  x -= Real(0.5);
  y -= Real(0.5);
  const Real left = std::floor(x), top = std::floor(y);
  return {clamp(left, width),           clamp(top, height), clamp(left + Real(1), width),
          clamp(top + Real(1), height), x - left,           y - top};
}

}  // namespace lamina
