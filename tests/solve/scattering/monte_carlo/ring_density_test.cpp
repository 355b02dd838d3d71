// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/ring_density.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "lamina/base/core/random.h"

namespace lamina {
namespace {

constexpr double first = 1e-3, width = 0.03;
constexpr std::size_t count = 400;

/// Flux of exp(-r / 0.5) / (2 pi r 0.5) in each ring, as so many photons count it.
RingFlux count_exponential(double photons) {
  RingFlux rings{.first_radius = first, .log_width = width};
  Random random = make_random(4, 1);
  const auto within = [](double r) { return -std::expm1(-2.0 * r); };
  const auto counted = [&](double share) {
    // A normal deviate stands for a binomial one.
    const double deviation = std::sqrt(share * (1.0 - share) / photons);
    const double normal = std::sqrt(-2.0 * std::log(1.0 - random.uniform())) *
                          std::cos(2.0 * std::numbers::pi * random.uniform());
    const double hits = std::round(photons * std::max(0.0, share + deviation * normal));
    return Estimate{hits / photons, (std::sqrt(hits) + 1.0) / photons};
  };
  rings.nearer = counted(within(first));
  for (std::size_t i = 0; i < count; ++i)
    rings.flux.push_back(counted(within(rings.begin_of(i + 1)) - within(rings.begin_of(i))));
  return rings;
}

TEST(RingDensity, IsThatOfTheLightWithinItsError) {
  const RingFlux rings = count_exponential(1e6);
  std::vector<double> r;
  for (double radius = 0.01; radius < 3.0; radius *= 1.1) r.push_back(radius);
  const auto density = density_of_rings(rings, r);
  double square = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double truth = std::exp(-2.0 * r[i]) / (std::numbers::pi * r[i]);
    const double off = (density[i].value - truth) / density[i].standard_error;
    EXPECT_LT(std::abs(off), 4.5) << r[i];
    EXPECT_LT(density[i].standard_error, 0.03 * truth) << r[i];
    square += off * off;
  }
  // 1 but for the bias that hides in the noise.
  EXPECT_LT(std::sqrt(square / static_cast<double>(r.size())), 1.8);
}

TEST(RingDensity, KnowsLessFromFewerPhotons) {
  const std::vector<double> r = {0.1, 0.5, 2.0};
  const auto many = density_of_rings(count_exponential(1e6), r);
  const auto few = density_of_rings(count_exponential(1e4), r);
  for (std::size_t i = 0; i < r.size(); ++i)
    EXPECT_GT(few[i].standard_error, 4.0 * many[i].standard_error);
}

TEST(RingDensity, GoesOnAsAPowerNearerThanPhotonsReach) {
  const std::vector<double> r = {1e-5, 1e-4};
  const auto density = density_of_rings(count_exponential(1e6), r);
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double truth = 1.0 / (std::numbers::pi * r[i]);
    EXPECT_NEAR(density[i].value / truth, 1.0, 0.3) << r[i];
    EXPECT_GT(density[i].standard_error, 0.5 * std::abs(density[i].value - truth)) << r[i];
  }
}

TEST(RingDensity, IsUnknownWithoutLight) {
  RingFlux rings{.first_radius = first, .log_width = width};
  rings.flux.assign(count, {0.0, 1e-6});
  const auto density = density_of_rings(rings, std::vector{0.1, 1e4});
  for (const Estimate& at : density) EXPECT_TRUE(std::isinf(at.standard_error));
}

}  // namespace
}  // namespace lamina
