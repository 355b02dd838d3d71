// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/thickness_profiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/layers/optics/symmetric_slab.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina {
namespace {

/// Pale skin at 540 nm.
LayerStack skin() {
  return LayerStack(
      {{.medium = {.sigma_a = 0.6, .sigma_s = 24.0, .g = 0.8, .ior = 1.4}, .thickness = 0.06},
       {.medium = {.sigma_a = 0.25, .sigma_s = 12.0, .g = 0.8, .ior = 1.38}}},
      1.0, 1.38);
}

LayerStack stone(double roughness = 0.0) {
  return LayerStack(
      {{.medium = {.sigma_a = 0.004, .sigma_s = 2.6, .ior = 1.5}, .top = {.roughness = roughness}}},
      1.0, 1.5);
}

/// How far two profiles are apart, weighted by the flux of rings, relative.
double mean_difference(const std::vector<double>& r, const std::vector<double>& a,
                       const std::vector<double>& b) {
  double wrong = 0.0, all = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    wrong += r[i] * r[i] * std::abs(a[i] - b[i]);
    all += r[i] * r[i] * b[i];
  }
  return wrong / all;
}

const TransferProfileOptions in_the_mean{
    .accuracy = 0.005, .error = ProfileError::mean, .illumination = Illumination::diffuse};

Profile alone(const LayerStack& stack) {
  return transfer_profile({&stack, 1}, {}, in_the_mean).profile;
}

TEST(ThicknessProfiles, AgreeWithSlabsSolvedOneByOne) {
  struct Case {
    LayerStack stack;
    std::size_t slab;  ///< slabs of both ladders are among them
    double reflectance, transmittance;
  };
  const std::vector<Case> cases{{stone(), 0, 0.001, 0.001},
                                {stone(), 3, 0.001, 0.002},
                                {skin(), 0, 0.001, 0.05},
                                {skin(), 3, 0.001, 0.01},
                                {skin(), 6, 0.001, 0.005}};
  for (const auto& [stack, s, of_reflectance, of_transmittance] : cases) {
    const ThicknessProfiles found =
        thickness_profiles({&stack, 1}, {.thinnest = 0.3, .thickest = 3.5});
    ASSERT_GE(found.slabs.size(), 7u);
    const Profile single = alone(make_slab(stack, found.thickness[s]));
    const Profile& slab = found.slabs[s];
    EXPECT_LT(mean_difference(slab.r, slab.reflectance_profile, single.reflectance_profile),
              of_reflectance)
        << found.thickness[s];
    EXPECT_LT(mean_difference(slab.r, slab.transmittance_profile, single.transmittance_profile),
              of_transmittance)
        << found.thickness[s];
    if (s == 0) {
      EXPECT_LT(mean_difference(found.half_space.r, found.half_space.reflectance_profile,
                                alone(stack).reflectance_profile),
                0.001);
    }
  }
}

TEST(ThicknessProfiles, HalfSpacesAloneTakeFewerDirections) {
  for (const LayerStack& stack : {skin(), stone()}) {
    const ThicknessProfiles found = thickness_profiles({&stack, 1}, {.thickest = 0.0});
    EXPECT_TRUE(found.slabs.empty());
    EXPECT_TRUE(thickness_profiles({&stack, 1}, {.thinnest = 190.0}).slabs.empty());
    EXPECT_LT(mean_difference(found.half_space.r, found.half_space.reflectance_profile,
                              alone(stack).reflectance_profile),
              0.001);
  }
}

// Totals by another solver; thicker slabs reflect more and transmit less, to those of the half-
// space.
TEST(ThicknessProfiles, HasTheTotalsOfItsSlabs) {
  const std::vector<LayerStack> bands{skin(), skin()};
  const ThicknessProfiles found = thickness_profiles(bands, {.thinnest = 0.2});
  double reflected = 0.0, transmitted = 1.0;
  for (std::size_t s = 0; s < found.slabs.size(); ++s) {
    const Profile& slab = found.slabs[s];
    const SlabTotals totals =
        adding_doubling(make_slab(skin(), found.thickness[s]), {.is_diffuse = true}).totals;
    for (std::size_t b = 0; b < 2; ++b) {
      EXPECT_NEAR(slab.total_reflectance[b], totals.diffuse_reflectance, 2e-4);
      EXPECT_NEAR(slab.total_transmittance[b], totals.transmittance, 2e-4);
    }
    EXPECT_GE(slab.total_reflectance[0], reflected - 1e-6);
    EXPECT_LT(slab.total_transmittance[0], transmitted);
    reflected = slab.total_reflectance[0];
    transmitted = slab.total_transmittance[0];
    if (s > 0) {
      EXPECT_NEAR((found.thickness[s] - 0.12) / (found.thickness[s - 1] - 0.12), std::sqrt(2.0),
                  1e-9);
    }
  }
  EXPECT_NEAR(reflected, found.half_space.total_reflectance[1], 2e-3);
  EXPECT_LT(transmitted, 2e-3);
  EXPECT_GT(found.slabs[found.slabs.size() - 2].total_transmittance[0], 2e-3 * 0.95);
}

TEST(ThicknessProfiles, TakesSmoothLayersThatScatter) {
  const auto takes = [](const LayerStack& stack) { return takes_thickness_profiles({&stack, 1}); };
  EXPECT_TRUE(takes(skin()));
  EXPECT_FALSE(takes(stone(0.1)));
  EXPECT_FALSE(takes(make_slab(skin(), 1.0)));
  EXPECT_FALSE(takes(LayerStack(
      {{.medium = {.ior = 1.4}, .thickness = 0.1}, {.medium = {.sigma_s = 2.0, .ior = 1.4}}}, 1.0,
      1.4)));
}

TEST(ThicknessProfiles, StopsWhenAsked) {
  const LayerStack stack = skin();
  int calls = 0;
  const auto stop = [&](double) { return ++calls < 4; };
  EXPECT_THROW((void)thickness_profiles({&stack, 1}, {.thinnest = 0.2}, {}, stop), Interrupted);
}

}  // namespace
}  // namespace lamina
