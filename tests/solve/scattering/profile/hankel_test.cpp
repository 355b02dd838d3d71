// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/profile/hankel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/solve/scattering/diffusion/dipole.h"

namespace lamina {
namespace {

using std::numbers::pi;

/// Largest relative error where the profile exceeds `part` of its peak.
double worst_error(const RadialGrid& grid, double part,
                   const std::function<double(double)>& spectrum,
                   const std::function<double(double)>& profile) {
  const HankelPlan plan = make_hankel_plan(grid);
  std::vector<double> samples, exact;
  for (const double k : plan.k) samples.push_back(spectrum(k));
  for (const double r : plan.r) exact.push_back(profile(r));
  const std::vector<double> found = inverse_hankel(plan, samples, 1);
  const double peak = *std::max_element(exact.begin(), exact.end());
  double worst = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i)
    if (exact[i] > part * peak) worst = std::max(worst, std::abs(found[i] / exact[i] - 1.0));
  return worst;
}

// A single image source is the steepest spectrum of diffusion, the dipole a sum of two: profiles
// in closed form over all scales of length and absorption.
TEST(Hankel, TurnsDipolesBackToTheirProfiles) {
  for (const double l : {1e-3, 0.02, 1.0, 10.0})
    for (const double absorption : {0.0, 1e-6, 1e-2, 0.5, 3.0}) {
      const Dipole dipole = {
          .z_r = l, .z_v = 5.0 * l, .sigma_tr = absorption / l, .albedo_prime = 0.9};
      EXPECT_LT(worst_error(
                    {}, 1e-8, [&](double k) { return reflectance_at_frequency(dipole, k); },
                    [&](double r) { return reflectance_profile(dipole, r); }),
                2e-7)
          << "l " << l << ", sigma_tr l " << absorption;
    }
}

// What very thick absorbing layers transmit is nearly a Gaussian, the most sudden of spectra:
// the kernel's band limit costs 1e-13 of its scale.
TEST(Hankel, TurnsGaussiansIntoGaussians) {
  for (const double v : {1e-4, 0.3, 50.0})
    EXPECT_LT(worst_error(
                  {}, 1e-8, [&](double k) { return std::exp(-0.5 * v * k * k); },
                  [&](double r) { return std::exp(-0.5 * r * r / v) / (2.0 * pi * v); }),
              1e-5)
        << "variance " << v;
}

// A spectrum that falls as 1 / k, as of light scattered once: the profile peaks as 1 / r.
TEST(Hankel, FollowsPeaksOfSingleScattering) {
  EXPECT_LT(worst_error(
                {}, 1e-8, [](double k) { return 1.0 / std::hypot(1.0, k); },
                [](double r) { return std::exp(-r) / (2.0 * pi * r); }),
            2e-7);
}

TEST(Hankel, DoesNotDependOnTheGrid) {
  const Dipole dipole = {.z_r = 0.5, .z_v = 2.0, .sigma_tr = 0.7, .albedo_prime = 1.0};
  for (const RadialGrid& grid : {RadialGrid{0.01, 10.0, 2}, RadialGrid{1e-6, 1e4, 31},
                                 RadialGrid{1.0, 1.001, 7}, RadialGrid{1e-3, 1e2, 3001}})
    EXPECT_LT(worst_error(
                  grid, 1e-8, [&](double k) { return reflectance_at_frequency(dipole, k); },
                  [&](double r) { return reflectance_profile(dipole, r); }),
              2e-7)
        << grid.size;
}

TEST(Hankel, TurnsManySpectraAtOnceAsOneByOne) {
  const HankelPlan plan = make_hankel_plan({});
  std::vector<double> both, first, second;
  for (const double k : plan.k) {
    first.push_back(std::exp(-k));
    second.push_back(std::exp(-0.1 * k));
    both.insert(both.end(), {first.back(), second.back()});
  }
  const auto together = inverse_hankel(plan, both, 2);
  const auto one = inverse_hankel(plan, first, 1), two = inverse_hankel(plan, second, 1);
  for (std::size_t i = 0; i < plan.r.size(); ++i) {
    EXPECT_NEAR(together[2 * i], one[i], 1e-13 * std::abs(one[i]));
    EXPECT_NEAR(together[2 * i + 1], two[i], 1e-13 * std::abs(two[i]));
  }
}

TEST(Hankel, WrongGridsAreRefused) {
  EXPECT_THROW((void)radii({.first = 0.0}), InvalidInput);
  EXPECT_THROW((void)radii({.first = 2.0, .last = 1.0}), InvalidInput);
  EXPECT_THROW((void)radii({.size = 1}), InvalidInput);
  EXPECT_THROW((void)radii({.last = std::nan("")}), InvalidInput);
}

}  // namespace
}  // namespace lamina
