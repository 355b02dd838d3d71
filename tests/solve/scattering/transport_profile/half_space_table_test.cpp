// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/half_space_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina {
namespace {

/// A half-space of extinction 2.3 /mm, of which the square of `place` absorbs.
LayerStack thick_medium(double place, double g, double ior) {
  constexpr double sigma_t_prime = 2.3;
  return LayerStack({{.medium = {.sigma_a = sigma_t_prime * place * place,
                                 .sigma_s = sigma_t_prime * (1.0 - place * place) / (1.0 - g),
                                 .g = g,
                                 .ior = ior}}},
                    1.0, ior);
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

// Between its places, at reflectances of .9 to .01: totals by another solver, profiles one by one.
TEST(HalfSpaceTable, HasTheProfilesOfSinglyMadeHalfSpaces) {
  constexpr double g = 0.3, ior = 1.35;
  const HalfSpaceTable table(thick_medium(0.5, g, ior), std::nullopt);
  for (const double place : {0.005, 0.045, 0.13, 0.27, 0.55, 0.86, 0.95}) {
    const LayerStack stack = thick_medium(place, g, ior);
    ASSERT_TRUE(table.covers(stack));
    const HalfSpaceTable* const of_band = &table;
    const Profile found = HalfSpaceTable::profile({&of_band, 1}, {&stack, 1});
    const double total = adding_doubling(stack, {.is_diffuse = true}).totals.diffuse_reflectance;
    EXPECT_NEAR(found.total_reflectance[0], total, 2e-4 * total) << place;
    const Profile single = transfer_profile({&stack, 1}, {}, in_the_mean).profile;
    EXPECT_LT(mean_difference(found.r, found.reflectance_profile, single.reflectance_profile),
              0.002)
        << place;
  }
}

TEST(HalfSpaceTable, CoversOneIndexPhaseFunctionAndSurface) {
  const LayerStack stack = thick_medium(0.3, 0.0, 1.0);
  EXPECT_TRUE(HalfSpaceTable::is_for(stack));
  EXPECT_FALSE(HalfSpaceTable::is_for(LayerStack({{.medium = {.sigma_a = 1.0}}})));
  EXPECT_FALSE(
      HalfSpaceTable::is_for(LayerStack({{.medium = {.sigma_s = 1.0}, .thickness = 1.0}})));
  const HalfSpaceTable table(stack, std::nullopt);
  EXPECT_TRUE(table.covers(thick_medium(0.9, 0.0, 1.0)));
  EXPECT_FALSE(table.covers(thick_medium(0.3, 0.1, 1.0)));
  EXPECT_FALSE(table.covers(thick_medium(0.3, 0.0, 1.1)));
  EXPECT_THROW(
      HalfSpaceTable(thick_medium(0.3, 0.2, 1.0), std::nullopt, [](double) { return false; }),
      Interrupted);
}

// What pictures take: an accuracy of 2 % in the mean, far better than diffusion.
TEST(TransferProfileInTheMean, IsWithinItsAccuracyOfFinerProfiles) {
  const Layer medium{.medium = {.sigma_a = 0.17, .sigma_s = 4.4, .g = 0.8, .ior = 1.4}};
  Layer slab = medium;
  slab.thickness = 1.5;
  for (const LayerStack& stack : {LayerStack({medium}, 1.0, 1.4), LayerStack({slab}, 1.0, 1.0)}) {
    const TransferProfile coarse = transfer_profile(
        {&stack, 1}, {},
        {.accuracy = 0.02, .error = ProfileError::mean, .illumination = Illumination::diffuse});
    const Profile fine =
        transfer_profile({&stack, 1}, {},
                         {.accuracy = 0.005, .illumination = Illumination::diffuse})
            .profile;
    EXPECT_TRUE(coarse.is_accurate);
    EXPECT_EQ(coarse.photons[0], 0u);
    const std::vector<double>& r = fine.r;
    EXPECT_LT(mean_difference(r, coarse.profile.reflectance_profile, fine.reflectance_profile),
              0.01);
    if (is_semi_infinite(stack)) continue;
    EXPECT_LT(mean_difference(r, coarse.profile.transmittance_profile, fine.transmittance_profile),
              0.01);
  }
}

}  // namespace
}  // namespace lamina
