// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/quadrature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lamina {
namespace {

TEST(GaussLegendre, IntegratesPolynomialsOfDegreeTwiceTheNodesLessOneExactly) {
  for (const int n : {1, 2, 3, 8, 33, 200}) {
    const Quadrature rule = gauss_legendre(n, 0.0, 2.0);
    const int degree = 2 * n - 1;
    double sum = 0.0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i)
      sum += rule.weights[i] * std::pow(rule.nodes[i] / 2.0, degree);
    EXPECT_NEAR(sum * (degree + 1.0) / 2.0, 1.0, 1e-12) << n << " nodes";
  }
}

TEST(GaussLegendre, HasAscendingNodesInsideAndPositiveWeights) {
  const Quadrature rule = gauss_legendre(17, -3.0, 5.0);
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    EXPECT_GT(rule.weights[i], 0.0);
    EXPECT_GT(rule.nodes[i], i == 0 ? -3.0 : rule.nodes[i - 1]);
    EXPECT_LT(rule.nodes[i], 5.0);
  }
}

TEST(Integrate, MatchesClosedForms) {
  EXPECT_NEAR(integrate([](double x) { return std::exp(x); }, 0.0, 1.0), std::numbers::e - 1.0,
              1e-12);
  EXPECT_NEAR(integrate([](double x) { return std::sqrt(x); }, 0.0, 1.0), 2.0 / 3.0, 1e-9);
  EXPECT_NEAR(integrate([](double x) { return 1.0 / (1e-4 + x * x); }, -1.0, 1.0),
              200.0 * std::atan(100.0), 1e-6);
}

TEST(Integrate, EndsForAnIntegrandThatIsNotANumber) {
  EXPECT_TRUE(std::isnan(integrate([](double) { return std::nan(""); }, 0.0, 1.0)));
}

}  // namespace
}  // namespace lamina
