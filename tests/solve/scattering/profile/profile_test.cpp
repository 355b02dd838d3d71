// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/profile/profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/solve/scattering/diffusion/diffusion_profile.h"
#include "lamina/solve/scattering/diffusion/dipole.h"

namespace lamina {
namespace {

const Medium milk = {.sigma_a = 0.01, .sigma_s = 2.0, .ior = 1.3};

Profile milk_profile() { return make_diffusion_profile(std::vector{LayerStack({{milk}})}).profile; }

TEST(Profile, InterpolatesBetweenItsRadii) {
  const Profile profile = milk_profile();
  const Dipole dipole = make_dipole(milk, 1.0);
  for (double r = 1e-4; r < 60.0; r *= 1.0137) {
    const double exact = reflectance_profile(dipole, r);
    // Cubics over steps of 4.5 % err by some 1e-5 of a profile that falls as exp(-16).
    EXPECT_NEAR(reflectance_profile(profile, r, 0), exact, 5e-5 * exact) << "r " << r;
  }
}

TEST(Profile, StaysMonotoneWhereItsValuesAre) {
  const Profile steps = {.bands = 1,
                         .r = {1.0, 2.0, 3.0, 10.0, 11.0},
                         .reflectance_profile = {5.0, 5.0, 1.0, 0.9, 0.0},
                         .transmittance_profile = {0.0, 0.0, 0.0, 0.0, 0.0},
                         .total_reflectance = {1.0},
                         .total_transmittance = {0.0}};
  double last = 5.0;
  for (double r = 0.5; r < 20.0; r += 0.01) {
    const double value = reflectance_profile(steps, r, 0);
    EXPECT_LE(value, last + 1e-12);
    EXPECT_GE(value, 0.0);
    EXPECT_EQ(transmittance_profile(steps, r, 0), 0.0);
    last = value;
  }
}

TEST(Profile, FluxAddsUpFromTheBeamOutward) {
  const Profile profile = milk_profile();
  const FluxCurve curve = reflected_flux(profile, 0);
  const Dipole dipole = make_dipole(milk, 1.0);
  // Flux of one image source within r: 1 - z / d exp(-sigma_tr (d - z)) of its exp(-sigma_tr z)
  // / 2.
  for (std::size_t i = 0; i < profile.r.size(); i += 15) {
    double exact = 0.0;
    for (const double z : {dipole.z_r, dipole.z_v}) {
      const double d = std::hypot(profile.r[i], z), x = dipole.sigma_tr;
      exact += 0.5 * dipole.albedo_prime * (std::exp(-x * z) - z / d * std::exp(-x * d));
    }
    EXPECT_NEAR(curve.within[i], exact, 1e-5 * exact) << "r " << profile.r[i];
  }
  EXPECT_NEAR(curve.within.back() + curve.beyond, total_reflectance(dipole), 1e-5);
}

TEST(Profile, ArrivingAndEnteredFluxDifferByTheEntryTransmittance) {
  const Profile entered = milk_profile();
  const double t = 0.98;
  const Profile arriving = per_arriving_flux(entered, std::vector{t});
  EXPECT_EQ(arriving.per, ProfilePer::arriving_flux);
  EXPECT_DOUBLE_EQ(arriving.reflectance_at(50, 0), t * entered.reflectance_at(50, 0));
  EXPECT_DOUBLE_EQ(arriving.total_reflectance[0], t * entered.total_reflectance[0]);
  const Profile back = per_entered_flux(arriving, std::vector{t});
  EXPECT_DOUBLE_EQ(back.reflectance_at(50, 0), entered.reflectance_at(50, 0));
  const Profile same = per_arriving_flux(arriving, std::vector{t});  // it is so already
  EXPECT_EQ(same.total_reflectance[0], arriving.total_reflectance[0]);
}

}  // namespace
}  // namespace lamina
