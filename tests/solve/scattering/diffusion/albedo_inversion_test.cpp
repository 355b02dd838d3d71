// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/albedo_inversion.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/solve/scattering/diffusion/dipole.h"
#include "literal/diffusion_skin.h"

namespace lamina {
namespace {

TEST(AlbedoInversion, RecoversTheAlbedoOfADipole) {
  for (const double ior : {1.0, 1.33, 1.5})
    for (const double alpha : {1e-6, 0.1, 0.5, 0.9, 0.99, 0.9999, 0.999999, 1.0}) {
      const Medium medium = {.sigma_a = 1.0 - alpha, .sigma_s = alpha, .ior = ior};
      const double reflectance = total_reflectance(make_dipole(medium, 1.0));
      const AlbedoInversion found = invert_dipole_albedo(reflectance, ior, 1.0);
      EXPECT_TRUE(found.converged);
      EXPECT_NEAR(found.albedo_prime, alpha, 1e-11) << "ior " << ior;
    }
}

TEST(AlbedoInversion, SaysWhenNoAlbedoServes) {
  const AlbedoInversion brighter_than_white = invert_dipole_albedo(1.1, 1.4, 1.0);
  EXPECT_FALSE(brighter_than_white.converged);
  EXPECT_EQ(brighter_than_white.albedo_prime, 1.0);
  EXPECT_NEAR(brighter_than_white.residual, -0.1, 1e-12);
  EXPECT_EQ(invert_dipole_albedo(0.0, 1.4, 1.0).albedo_prime, 0.0);
  EXPECT_FALSE(invert_dipole_albedo(-0.1, 1.4, 1.0).converged);
}

TEST(AlbedoInversion, WorksForAnyModelOfTheTotal) {
  // A slab 2 mm thick of sigma_t' = 3 / mm, by the multipole.
  const auto slab = [](double alpha) {
    const Medium medium = {.sigma_a = 3.0 * (1.0 - alpha), .sigma_s = 3.0 * alpha, .ior = 1.4};
    if (alpha == 0.0) return 0.0;
    return response(make_layered_diffusion(LayerStack({{.medium = medium, .thickness = 2.0}})), 0.0)
        .reflection_above;
  };
  const AlbedoInversion found = invert_albedo(slab, slab(0.93));
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.albedo_prime, 0.93, 1e-10);
  EXPECT_FALSE(invert_albedo(slab, 0.99).converged);  // some passes, whatever the albedo
}

RC_GTEST_PROP(AlbedoInversionLaw, MediumHasTheLookThatItWasMadeFrom, ()) {
  const DiffuseLook look = {.reflectance = 0.001 * *rc::gen::inRange(1, 999),
                            .diffuse_mfp = std::pow(10.0, 0.1 * *rc::gen::inRange(-30, 30))};
  const Medium medium = medium_from_look(look, 0.8, 1.4, 1.0);
  const double reflectance = total_reflectance(make_dipole(medium, 1.0));
  RC_ASSERT(std::abs(reflectance - look.reflectance) < 1e-10);
  RC_ASSERT(std::abs(sigma_tr(medium) * look.diffuse_mfp - 1.0) < 1e-9);
}

TEST(AlbedoInversion, ImpossibleLooksAreRefused) {
  EXPECT_THROW((void)medium_from_look({1.0, 1.0}, 0.0, 1.4, 1.0), InvalidInput);
  EXPECT_THROW((void)medium_from_look({std::nan(""), 1.0}, 0.0, 1.4, 1.0), InvalidInput);
  EXPECT_THROW((void)medium_from_look({0.5, 0.0}, 0.0, 1.4, 1.0), InvalidInput);
}

TEST(AlbedoInversion, HalfSpaceIsItsOwnEquivalent) {
  const Medium medium = {.sigma_a = 0.03, .sigma_s = 2.0, .ior = 1.35};
  const Medium found = equivalent_half_space(LayerStack({{.medium = medium}}));
  EXPECT_NEAR(found.sigma_a, medium.sigma_a, 1e-9);
  EXPECT_NEAR(found.sigma_s, medium.sigma_s, 1e-8);
}

TEST(AlbedoInversion, EquivalentOfSkinHasItsTotalAndItsHalfFrequency) {
  for (const LayerStack& skin : reference::donner_jensen_skin()) {
    const LayeredDiffusion model = make_layered_diffusion(skin);
    const Dipole one = make_dipole(equivalent_half_space(skin), 1.0);
    const double total = response(model, 0.0).reflection_above;
    EXPECT_NEAR(total_reflectance(one), total, 1e-10);
    double k = 1e-3;  // the first frequency, to 1 %, at which the skin is below its half
    while (response(model, k).reflection_above > 0.5 * total) k *= 1.01;
    EXPECT_NEAR(reflectance_at_frequency(one, k), 0.5 * total, 0.01 * total);
  }
}

}  // namespace
}  // namespace lamina
