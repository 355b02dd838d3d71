// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/reflectance/cubic_table.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lamina {
namespace {

using Values = std::array<double, 2>;

// Keys's cubics are exact for parabolas, up to the ends.
TEST(CubicTable, IsExactForParabolas) {
  const auto parabola = [](double u, double v) -> Values {
    return {1.0 + 2.0 * u - 0.5 * u * u + v, (3.0 - v * v) * u};
  };
  const CubicTable<2> table({-1.0, 2.0, 7}, {0.5, 4.0, 5}, parabola);
  for (const double u : {-1.0, -0.93, 0.0, 0.5, 1.3, 1.99, 2.0})
    for (const double v : {0.5, 0.6, 2.0, 3.7, 4.0}) {
      const auto [value, by] = table.at(u, v);
      for (std::size_t f = 0; f < 2; ++f) EXPECT_NEAR(value[f], parabola(u, v)[f], 1e-13);
      EXPECT_NEAR(by[0][0], 2.0 - u, 1e-12);
      EXPECT_NEAR(by[0][1], 3.0 - v * v, 1e-12);
      EXPECT_NEAR(by[1][0], 1.0, 1e-12);
      EXPECT_NEAR(by[1][1], -2.0 * v * u, 1e-12);
    }
}

TEST(CubicTable, IsFlatBeyondItsEnds) {
  const CubicTable<2> table({0.0, 1.0, 4}, {0.0, 1.0, 4}, [](double u, double v) -> Values {
    return {u + v, u * v};
  });
  const auto [value, by] = table.at(1.5, -2.0);
  EXPECT_NEAR(value[0], 1.0, 1e-15);
  EXPECT_NEAR(value[1], 0.0, 1e-15);
  EXPECT_EQ(by[0], (Values{0.0, 0.0}));
  EXPECT_EQ(by[1], (Values{0.0, 0.0}));
}

TEST(CubicTable, ConvergesWithTheThirdPowerOfTheStep) {
  const auto error = [](std::size_t nodes) {
    const CubicTable<2> table({0.0, 1.0, nodes}, {0.0, 1.0, nodes},
                              [](double u, double v) -> Values {
                                return {std::sin(3.0 * u) * std::exp(v), 0.0};
                              });
    double worst = 0.0;
    for (int i = 0; i <= 97; ++i)
      for (int j = 0; j <= 89; ++j) {
        const double u = i / 97.0, v = j / 89.0;
        worst =
            std::max(worst, std::abs(table.at(u, v).value[0] - std::sin(3.0 * u) * std::exp(v)));
      }
    return worst;
  };
  EXPECT_NEAR(std::log2(error(11) / error(21)), 3.0, 0.4);
}

}  // namespace
}  // namespace lamina
