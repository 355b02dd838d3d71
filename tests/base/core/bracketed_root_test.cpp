// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/bracketed_root.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lamina {
namespace {

TEST(FallingRoot, MeetsRootsThatAreKnown) {
  int calls = 0;
  const auto root_of = [&](const auto& f, double low, double high) {
    calls = 0;
    return falling_root(
               [&](double x) {
                 ++calls;
                 return f(x);
               },
               low, high, 1e-13)
        .place;
  };
  EXPECT_NEAR(root_of([](double x) { return 0.3 - x; }, 0.0, 1.0), 0.3, 1e-13);
  EXPECT_LE(calls, 3);
  EXPECT_NEAR(root_of([](double x) { return 2.0 - x * x; }, 0.0, 10.0), std::sqrt(2.0), 1e-13);
  EXPECT_LE(calls, 20);
  // Steep on one side: false position alone creeps there.
  EXPECT_NEAR(root_of([](double x) { return 1e-3 - std::exp(x); }, -100.0, 20.0), std::log(1e-3),
              1e-9);
  EXPECT_LE(calls, 90);
  EXPECT_NEAR(root_of([](double x) { return -x * x * x; }, -1.0, 3.0), 0.0, 1e-4);
}

TEST(FallingRoot, EndsBesideAStep) {
  const BracketedRoot root =
      falling_root([](double x) { return x < 0.7 ? 1.0 : -2.0; }, 0.0, 1.0, 1e-12);
  EXPECT_NEAR(root.place, 0.7, 1e-12);
}

TEST(FallingRoot, IsTheNearestEndWhereThereIsNone) {
  const auto falling = [](double x) { return -x; };
  EXPECT_EQ(falling_root(falling, 1.0, 2.0, 1e-12).place, 1.0);
  EXPECT_EQ(falling_root(falling, 1.0, 2.0, 1e-12).value, -1.0);
  EXPECT_EQ(falling_root(falling, -2.0, -1.0, 1e-12).place, -1.0);
}

TEST(FallingRoot, EndsForAFunctionThatIsNotANumber) {
  const auto nothing = [](double) { return std::numeric_limits<double>::quiet_NaN(); };
  EXPECT_TRUE(std::isnan(falling_root(nothing, 0.0, 1.0, 1e-12).value));
}

}  // namespace
}  // namespace lamina
