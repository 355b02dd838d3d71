// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/phase_function.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "lamina/base/core/quadrature.h"
#include "lamina/base/core/random.h"

namespace lamina {
namespace {

const std::vector<PhaseFunction> phases = {
    HenyeyGreenstein{-0.6},
    HenyeyGreenstein{0.0},
    HenyeyGreenstein{1e-5},
    HenyeyGreenstein{0.9},
    Rayleigh{},
    PhaseMixture{{{0.7, HenyeyGreenstein{0.8}}, {0.3, Rayleigh{}}}}};

TEST(PhaseFunction, HasUnitIntegralAndItsLegendreMoments) {
  for (const PhaseFunction& phase : phases)
    for (const int l : {0, 1, 2, 5}) {
      const double moment =
          2.0 * std::numbers::pi *
          integrate(
              [&](double c) {
                return std::legendre(static_cast<unsigned>(l), c) * evaluate(phase, c);
              },
              -1.0, 1.0, 1e-12);
      EXPECT_NEAR(moment, legendre_moment(phase, l), 1e-9) << phase.index() << " l " << l;
    }
}

// 50 bins of equal probability by the quadrature of the density; 4 standard deviations of
// chi-square.
TEST(PhaseFunction, SamplesFollowTheDensity) {
  for (const PhaseFunction& phase : phases) {
    constexpr int bins = 50, draws = 200'000;
    std::vector<double> count(bins), expected(bins);
    const auto density = [&](double c) { return 2.0 * std::numbers::pi * evaluate(phase, c); };
    for (int i = 0; i < bins; ++i)
      expected[static_cast<std::size_t>(i)] =
          draws * integrate(density, -1.0 + 2.0 * i / bins, -1.0 + 2.0 * (i + 1) / bins, 1e-10);
    Random random = make_random(3, phase.index());
    for (int i = 0; i < draws; ++i) {
      const double c = sample_cos_theta(phase, random.uniform(), random.uniform());
      ASSERT_GE(c, -1.0);
      ASSERT_LE(c, 1.0);
      count[std::min<std::size_t>(bins - 1, static_cast<std::size_t>(0.5 * (c + 1.0) * bins))] += 1;
    }
    double chi2 = 0.0;
    for (std::size_t i = 0; i < bins; ++i)
      chi2 += (count[i] - expected[i]) * (count[i] - expected[i]) / expected[i];
    EXPECT_NEAR(chi2, bins - 1, 4.0 * std::sqrt(2.0 * (bins - 1))) << phase.index();
  }
}

}  // namespace
}  // namespace lamina
