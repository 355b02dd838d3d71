// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/profile/radial_sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/core/error.h"
#include "lamina/core/quadrature.h"
#include "lamina/core/random.h"
#include "lamina/scattering/diffusion/diffusion_profile.h"
#include "lamina/scattering/heterogeneous/thin_geometry.h"
#include "literal/diffusion_skin.h"

namespace lamina {
namespace {

const Profile& skin() {
  static const Profile profile = make_diffusion_profile(reference::donner_jensen_skin()).profile;
  return profile;
}

TEST(RadialSampler, DensityIntegratesToOneAndToTheFractionWithin) {
  const RadialSampler sampler = make_radial_sampler(skin(), ProfileSide::reflectance);
  for (const double to : {5e-4, 0.01, 0.3, 5.0, 99.0, 1e6}) {
    const double mass = integrate(
        [&](double log_r) { return std::exp(log_r) * pdf_radius(sampler, std::exp(log_r)); },
        std::log(1e-7), std::log(to), 1e-9);
    EXPECT_NEAR(mass, fraction_within(sampler, to), 1e-6) << to;
  }
  EXPECT_NEAR(fraction_within(sampler, 1e9), 1.0, 1e-12);
}

TEST(RadialSampler, SamplesInvertTheFractionWithin) {
  for (const ProfileSide side : {ProfileSide::reflectance, ProfileSide::both}) {
    const RadialSampler sampler = make_radial_sampler(skin(), side);
    for (double u = 0.0005; u < 1.0; u += 0.001)
      EXPECT_NEAR(fraction_within(sampler, sample_radius(sampler, u)), u, 1e-12);
    EXPECT_GT(sample_radius(sampler, 0.0), 0.0);
    EXPECT_TRUE(std::isfinite(sample_radius(sampler, 1.0 - 0x1p-53)));
  }
}

TEST(RadialSampler, WeightsOfAllBandsAreBoundedAndAverageToTheTotals) {
  const RadialSampler sampler = make_radial_sampler(skin(), ProfileSide::reflectance);
  EXPECT_GE(sampler.weight_bound, 1.0 - 1e-3);
  EXPECT_LE(sampler.weight_bound, 3.0);
  constexpr int n = 20000;
  for (std::size_t b = 0; b < 3; ++b) {
    double sum = 0.0, largest = 0.0;
    for (int i = 0; i < n; ++i) {
      const double r = sample_radius(sampler, (i + 0.5) / n);
      const double weight =
          2.0 * std::numbers::pi * r * reflectance_profile(skin(), r, b) / pdf_radius(sampler, r);
      sum += weight;
      largest = std::max(largest, weight);
    }
    EXPECT_NEAR(sum / n, skin().total_reflectance[b], 1e-3 * skin().total_reflectance[b]);
    // The sampler is straight between radii in log-log axes, the profile curved: 1 % apart.
    EXPECT_LT(largest, 1.01 * sampler.weight_bound * skin().total_reflectance[b]);
  }
}

TEST(RadialSampler, ProfileWithoutFluxIsRefused) {
  EXPECT_THROW((void)make_radial_sampler(skin(), ProfileSide::transmittance), InvalidInput);
}

TEST(ThinGeometry, BlendsFromReflectionToTransmissionByTheNormals) {
  EXPECT_EQ(thin_geometry_blend(1.0).reflectance, 1.0);
  EXPECT_EQ(thin_geometry_blend(-1.0).reflectance, 0.0);
  EXPECT_EQ(thin_geometry_blend(Vec3{0, 0, 1}, Vec3{1, 0, 0}).transmittance, 0.5);
  const Profile leaf =
      make_diffusion_profile(
          std::vector{LayerStack({{.medium = {.sigma_s = 9.0, .ior = 1.4}, .thickness = 0.3}})})
          .profile;
  EXPECT_DOUBLE_EQ(blended_profile(leaf, 0.2, 0, thin_geometry_blend(0.0)),
                   0.5 * (reflectance_profile(leaf, 0.2, 0) + transmittance_profile(leaf, 0.2, 0)));
}

}  // namespace
}  // namespace lamina
