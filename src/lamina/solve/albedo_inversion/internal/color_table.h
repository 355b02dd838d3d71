// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "lamina/layers/optics/layer_stack.h"

namespace lamina::detail {

// What the table of colors holds: for beams at 0 degrees and for diffuse light the share C of the
// light that gets in which comes out again, as q in
//
//   C = (1 - s) exp(s q),   s = sqrt((1 - albedo) / (1 - albedo g)),
//
// a product of Chebyshev polynomials of s, g and coordinates of index and roughness. By similarity
// half-spaces of one s are nearly alike; C is 1 at s = 0 and 0 at s = 1. Besides, the share of the
// light that is reflected before it gets in, over index and roughness.

/// Points along each variable. The first is the sum's innermost.
inline constexpr std::size_t s_orders = 14, g_orders = 11, ior_orders = 14, roughness_orders = 13;

/// Coordinates in [-1, 1] over which the table is smooth.
[[nodiscard]] inline double s_coordinate(double s) { return 2.0 * s - 1.0; }
[[nodiscard]] inline double g_coordinate(double g) { return (g + 0.3) / 0.625 - 1.0; }
/// Coordinate of the index: the cosine of the critical angle, over which reflection is smooth down
/// to matched indices.
[[nodiscard]] inline double ior_coordinate(double ior) {
  const double highest = std::sqrt(1.0 - 1.0 / (1.6 * 1.6));
  return 2.0 * std::sqrt(1.0 - 1.0 / (ior * ior)) / highest - 1.0;
}
[[nodiscard]] inline double roughness_coordinate(double roughness) {
  return 2.0 * std::cbrt(roughness * roughness) - 1.0;
}

/// Coefficients are whole multiples of these.
inline constexpr double color_table_unit = 2e-6, first_reflection_unit = 1e-8;

/// Rows of the table, written by tools/fit/half_space_colors. For beckmann and ggx, for beams and
/// diffuse light, for each order of roughness, ior and g: how many orders of s follow, then these.
extern const std::span<const std::int32_t> color_table_rows;
/// [distribution][light][order of roughness][order of ior]
extern const std::span<const std::int32_t> first_reflection_rows;

/// Coefficients of one surface and g.
struct ColorCoefficients {
  std::array<double, s_orders> q = {};  ///< [order of s]
  double first_reflection = 0.0;
};
[[nodiscard]] ColorCoefficients color_coefficients(double ior, double g, const Interface& top,
                                                   bool is_diffuse);

}  // namespace lamina::detail
