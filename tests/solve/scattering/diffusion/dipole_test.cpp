// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/dipole.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"

namespace lamina {
namespace {

using std::numbers::pi;

template <class F>
double over_plane(const F& profile, double from, double to) {
  return integrate(
      [&](double log_r) {
        const double r = std::exp(log_r);
        return 2.0 * pi * r * r * profile(r);
      },
      std::log(from), std::log(to), 1e-12);
}

TEST(Dipole, HalfSpaceThatDoesNotAbsorbReturnsAllTheLight) {
  const Dipole dipole = make_dipole({.sigma_s = 2.0, .ior = 1.4}, 1.0);
  // Outside 1e8 mm remains some 1e-8 of it.
  EXPECT_NEAR(over_plane([&](double r) { return reflectance_profile(dipole, r); }, 1e-6, 1e8), 1.0,
              1e-7);
  EXPECT_DOUBLE_EQ(total_reflectance(dipole), 1.0);
}

// Far outside the dipole's two terms act as one: (z_r + z_v) / 2 / r^3, which leaves 5/3 l / a
// beyond radius a if the indices match.
TEST(Dipole, MatchedHalfSpaceWithoutAbsorptionLeavesFiveThirdsOfAFreePathOutside) {
  const Dipole dipole = make_dipole({.sigma_s = 1.0}, 1.0);
  const double a = 1000.0;
  EXPECT_NEAR(1.0 - over_plane([&](double r) { return reflectance_profile(dipole, r); }, 1e-6, a),
              5.0 / 3.0 / a, 1e-7);
}

// [Jensen2001] Eq. 15 with A of the boundary.
TEST(Dipole, TotalIsThePublishedClosedForm) {
  for (const double sigma_a : {0.0, 1e-3, 0.1, 2.0})
    for (const double ior : {1.0, 1.3, 1.5}) {
      const Medium medium = {.sigma_a = sigma_a, .sigma_s = 5.0, .g = 0.6, .ior = ior};
      const double alpha = albedo_prime(medium), root = std::sqrt(3.0 * (1.0 - alpha));
      const double f = fresnel_diffuse(1.0 / ior), A = (1.0 + f) / (1.0 - f);
      EXPECT_NEAR(total_reflectance(make_dipole(medium, 1.0)),
                  0.5 * alpha * (1.0 + std::exp(-4.0 / 3.0 * A * root)) * std::exp(-root), 1e-14);
    }
}

TEST(Dipole, ProfileOverFrequencyIsTheTransformOfTheProfileOverRadius) {
  const Dipole dipole = make_dipole({.sigma_a = 0.05, .sigma_s = 1.0, .ior = 1.4}, 1.0);
  for (const double k : {0.0, 0.1, 1.0, 3.0}) {
    const double transform = over_plane(
        [&](double r) { return reflectance_profile(dipole, r) * ::j0(k * r); }, 1e-8, 200.0);
    EXPECT_NEAR(reflectance_at_frequency(dipole, k), transform, 1e-10) << "k " << k;
  }
}

TEST(Dipole, LengthsScaleWithTheFreePath) {
  const Dipole one = make_dipole({.sigma_a = 0.1, .sigma_s = 1.0, .ior = 1.3}, 1.0);
  const Dipole tenth = make_dipole({.sigma_a = 1.0, .sigma_s = 10.0, .ior = 1.3}, 1.0);
  EXPECT_NEAR(reflectance_profile(tenth, 0.07), 100.0 * reflectance_profile(one, 0.7), 1e-13);
}

TEST(Dipole, DenserOutsideAndMatchedBoundariesKeepTheRightLimits) {
  // No reflection inside: the extrapolation distance is 2/3 of a free path, [DonnerJensen2005] §2.
  EXPECT_DOUBLE_EQ(make_dipole({.sigma_s = 1.0}, 1.0).z_v, 1.0 + 4.0 / 3.0);
  // Denser outside, light inside is never totally reflected, and less stays than from outside.
  const Dipole under_glass = make_dipole({.sigma_a = 0.1, .sigma_s = 1.0, .ior = 1.0}, 1.5);
  const Dipole under_air = make_dipole({.sigma_a = 0.1, .sigma_s = 1.0, .ior = 1.5}, 1.0);
  EXPECT_LT(under_glass.z_v, under_air.z_v);
  EXPECT_GT(total_reflectance(under_glass), total_reflectance(under_air));
}

}  // namespace
}  // namespace lamina
