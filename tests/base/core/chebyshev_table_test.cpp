// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/chebyshev_table.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace lamina {
namespace {

using Point = ChebyshevTable::Point;

constexpr ChebyshevTable::Box box{{-1.0, 0.5, 2.0}, {3.0, 2.0, 2.5}};

template <class Function>
ChebyshevTable table_of(const ChebyshevTable::Counts& counts, Function function) {
  std::vector<double> values;
  for (const double z : ChebyshevTable::points(box.low[2], box.high[2], counts[2]))
    for (const double y : ChebyshevTable::points(box.low[1], box.high[1], counts[1]))
      for (const double x : ChebyshevTable::points(box.low[0], box.high[0], counts[0]))
        values.push_back(function(x, y, z));
  return {box, counts, values};
}

double polynomial(double x, double y, double z) {
  return 1.0 + x * x * x - 2.0 * x * y * y * z + z * z * y;
}

TEST(ChebyshevTable, IsExactForPolynomialsOfItsDegrees) {
  const ChebyshevTable table = table_of({4, 3, 3}, polynomial);
  for (const Point& at : {Point{-1.0, 0.5, 2.0}, Point{0.3, 1.7, 2.2}, Point{3.0, 2.0, 2.5}}) {
    Point by;
    const auto [x, y, z] = at;
    EXPECT_NEAR(table.at(at, &by), polynomial(x, y, z), 1e-12);
    EXPECT_NEAR(table.at(at), polynomial(x, y, z), 1e-12);
    EXPECT_NEAR(by[0], 3.0 * x * x - 2.0 * y * y * z, 1e-11);
    EXPECT_NEAR(by[1], -4.0 * x * y * z + z * z, 1e-11);
    EXPECT_NEAR(by[2], -2.0 * x * y * y + 2.0 * z * y, 1e-11);
  }
}

// T_n(cos a) = cos(n a), of each degree that registers of any width may leave over.
TEST(ChebyshevTable, IsExactForHighDegrees) {
  for (int degree = 3; degree < ChebyshevTable::most_points; ++degree) {
    const auto angle = [](double x) { return std::acos(0.5 * (x - 1.0)); };
    const ChebyshevTable table = table_of({degree + 1, 2, 3}, [&](double x, double y, double z) {
      return std::cos(degree * angle(x)) * (y - z * z);
    });
    for (const Point& at : {Point{-0.9, 0.5, 2.0}, Point{0.3, 1.7, 2.2}, Point{2.8, 2.0, 2.5}}) {
      const auto [x, y, z] = at;
      const double wave = std::cos(degree * angle(x));
      const double slope = 0.5 * degree * std::sin(degree * angle(x)) / std::sin(angle(x));
      Point by;
      EXPECT_NEAR(table.at(at), wave * (y - z * z), 1e-11);
      EXPECT_NEAR(table.at(at, &by), wave * (y - z * z), 1e-11);
      EXPECT_NEAR(by[0], slope * (y - z * z), 1e-9);
      EXPECT_NEAR(by[1], wave, 1e-11);
      EXPECT_NEAR(by[2], -2.0 * z * wave, 1e-10);
    }
  }
}

TEST(ChebyshevTable, StaysAtTheEdgeOfItsBox) {
  const ChebyshevTable table = table_of({4, 3, 3}, polynomial);
  Point by;
  EXPECT_NEAR(table.at({9.0, 1.0, 2.2}, &by), polynomial(3.0, 1.0, 2.2), 1e-12);
  EXPECT_EQ(by[0], 0.0);
  EXPECT_NEAR(by[1], -4.0 * 3.0 * 2.2 + 2.2 * 2.2, 1e-11);
}

TEST(ChebyshevTable, OverAPartOfItsBoxIsTheSameFunction) {
  const auto wave = [](double x, double y, double z) {
    return std::exp(0.7 * x) * std::sin(y + z);
  };
  const ChebyshevTable table = table_of({16, 9, 7}, wave);
  const ChebyshevTable part = table.over({{0.0, 1.0, 2.1}, {1.0, 1.5, 2.1}}, {11, 7, 1});
  for (const Point& at : {Point{0.0, 1.0, 2.1}, Point{0.4, 1.4, 2.1}, Point{1.0, 1.5, 2.1}})
    EXPECT_NEAR(part.at(at), wave(at[0], at[1], at[2]), 1e-7);
}

TEST(ChebyshevTable, MixesByWeights) {
  const std::array tables = {table_of({2, 2, 2}, [](double x, double, double) { return x; }),
                             table_of({2, 2, 2}, [](double, double y, double z) { return y * z; })};
  const std::array weights = {0.5, -3.0};
  EXPECT_NEAR(ChebyshevTable::mixed(tables, weights).at({1.0, 1.5, 2.2}), 0.5 - 3.0 * 3.3, 1e-12);
}

}  // namespace
}  // namespace lamina
