// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/least_squares/small_fit.h"

#include <gtest/gtest.h>

#include "lamina/skin/fit/least_squares/nonlinear_fit.h"

namespace lamina {
namespace {

constexpr std::array<double, 5> times = {0.5, 1.0, 1.5, 2.5, 4.0};
constexpr std::array<double, 5> measured = {1.62, 1.22, 0.95, 0.55, 0.26};
constexpr double deviation = 0.02;

/// a exp(-b t)
SmallSquares<3> decay_squares(const SmallVector<3>& at) {
  SmallSquares<3> result;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double e = std::exp(-at[1] * times[k]);
    const std::array<double, 2> by = {e / deviation, -at[0] * times[k] * e / deviation};
    const double miss = (at[0] * e - measured[k]) / deviation;
    result.value += 0.5 * miss * miss;
    for (std::size_t i = 0; i < 2; ++i) {
      result.gradient[i] += by[i] * miss;
      for (std::size_t j = 0; j <= i; ++j) result.curvature[i][j] += by[i] * by[j];
    }
  }
  return result;
}

SmallFit<3> decay_fit(double highest) {
  SmallFit<3> fit{.size = 2, .shortest = 1e-9, .scale = {1.0, 1.0, 1.0}, .at = {1.0, 0.1, 0.0}};
  int accepted = 0;
  fit.run(
      decay_squares, [&](std::size_t, double x) { return std::min(x, highest); },
      [&](std::size_t, double x, double gradient) { return x >= highest && gradient < 0.0; },
      [&] { ++accepted; });
  EXPECT_GT(accepted, 1);
  return fit;
}

TEST(SmallFit, FindsWhatTheLargeOneDoes) {
  FitModel model;
  model.predict = [](std::span<const double> values) {
    std::vector<double> prediction;
    for (const double t : times) prediction.push_back(values[0] * std::exp(-values[1] * t));
    return prediction;
  };
  FitParameter amplitude{.name = "a", .low = 0.0, .high = 10.0}, rate = amplitude;
  amplitude.start = 1.0;
  rate.start = 0.1;
  const FitResult large =
      fit_parameters({amplitude, rate},
                     {.measured = {measured.begin(), measured.end()},
                      .standard_deviation = std::vector(measured.size(), deviation)},
                     model);
  const SmallFit<3> small = decay_fit(10.0);
  const SmallMatrix<3> covariance = small_covariance(small.squares.curvature, 2);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(small.at[i], large.parameters[i].value, 1e-6);
    EXPECT_NEAR(std::sqrt(covariance[i][i]), large.parameters[i].standard_deviation, 1e-5);
  }
  EXPECT_NEAR(2.0 * small.squares.value, large.chi_squared, 1e-6);
}

TEST(SmallFit, HoldsWhatIsAtItsEnd) {
  const SmallFit<3> fit = decay_fit(1.5);  // the amplitude wants 2
  EXPECT_EQ(fit.at[0], 1.5);
  EXPECT_LT(fit.squares.gradient[0], 0.0);
  EXPECT_NEAR(fit.squares.gradient[1] / std::sqrt(fit.squares.curvature[1][1]), 0.0, 1e-6);
}

}  // namespace
}  // namespace lamina
