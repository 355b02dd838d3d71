// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lamina/base/core/exact_sum.h"
#include "lamina/base/core/vec.h"

namespace lamina {

/// Sums of light and of distances: terms of 5e-20 to 5e11, those above 1e-12 with all digits of a
/// float.
using LightSum = ExactSum<2, 64>;
using LightSquareSum = ExactSum<3, 92>;
/// Exact sum of numbers in [-1, 1] or little beyond.
using UnitSum = ExactSum<1, 32>;

/// Sums of the three parts of colors and directions.
template <class Sum>
struct Sum3 {
  Sum x, y, z;

  void add(const Vec3f& term) {
    x.add(static_cast<double>(term.x));
    y.add(static_cast<double>(term.y));
    z.add(static_cast<double>(term.z));
  }
  [[nodiscard]] Vec3 value() const { return {x.value(), y.value(), z.value()}; }
  friend bool operator==(const Sum3&, const Sum3&) = default;
};

/// Sums over the samples of one pixel.
struct FilmPixel {
  Sum3<LightSum> beauty, subsurface, specular;
  LightSquareSum luminance_square;
  Sum3<UnitSum> normal, albedo;
  LightSum depth;  ///< [mm]
  std::int64_t samples = 0;
  std::int32_t hits = 0, subsurface_hits = 0;
  friend bool operator==(const FilmPixel&, const FilmPixel&) = default;
};

/// Kind of surface that all samples of a pixel have met.
enum class PixelCover : std::uint8_t { mixed, surface, translucent_surface };

}  // namespace lamina
