// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace lamina {

/// A smooth function of three variables in a box: a product of Chebyshev polynomials of each.
class ChebyshevTable {
 public:
  static constexpr std::size_t dimensions = 3;
  static constexpr int most_points = 32;  ///< along a variable
  using Point = std::array<double, dimensions>;
  using Counts = std::array<int, dimensions>;
  struct Box {
    Point low = {}, high = {};
  };

  /// The zeros of the polynomial of degree `count` in [low, high], from high to low.
  [[nodiscard]] static std::vector<double> points(double low, double high, int count);

  ChebyshevTable() = default;

  /// @param box     of some width along each variable; widened to 2e-6 where it is narrower
  /// @param counts  points along each, in [1, most_points]
  /// @param values  of the function at points(box), [3rd][2nd][1st variable]
  ChebyshevTable(const Box& box, const Counts& counts, std::vector<double> values);

  [[nodiscard]] const Box& box() const { return box_; }

  /// The value there; beyond the box that at its nearest place, with derivatives of 0 along what is
  /// beyond.
  [[nodiscard]] double at(const Point& point, Point* derivatives = nullptr) const;

  /// Interpolates the function anew over a part of the box.
  [[nodiscard]] ChebyshevTable over(const Box& box, const Counts& counts) const;

  /// Sum of functions of one box and counts, each times its weight.
  [[nodiscard]] static ChebyshevTable mixed(std::span<const ChebyshevTable> tables,
                                            std::span<const double> weights);

 private:
  Box box_;
  Counts counts_ = {};
  std::vector<double> coefficients_;  ///< [3rd][2nd][1st order], and some of 0 behind them
};

}  // namespace lamina
