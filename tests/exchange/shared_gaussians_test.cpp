// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/internal/shared_gaussians.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/solve/scattering/profile/gaussian_fit.h"

namespace lamina::detail {
namespace {

/// Two channels, sums of Gaussians of variances .01 and 1.
Profile made_of_gaussians(const std::vector<GaussianSum>& channels) {
  Profile profile{.per = ProfilePer::arriving_flux, .bands = channels.size()};
  for (double r = 1e-3; r < 30.0; r *= 1.04) profile.r.push_back(r);
  for (const double r : profile.r)
    for (const GaussianSum& channel : channels)
      profile.reflectance_profile.push_back(evaluate(channel, r));
  profile.transmittance_profile.assign(profile.reflectance_profile.size(), 0.0);
  for (const GaussianSum& channel : channels) {
    profile.total_reflectance.push_back(channel.weights[0] + channel.weights[1]);
    profile.total_transmittance.push_back(0.0);
  }
  return profile;
}

TEST(SharedGaussians, FindTheTwoThatAProfileIsMadeOf) {
  const std::vector<GaussianSum> made = {{{0.01, 1.0}, {0.3, 0.1}}, {{0.01, 1.0}, {0.05, 0.5}}};
  const SharedGaussians found = fit_shared_gaussians(made_of_gaussians(made), true, 2);
  EXPECT_LT(found.largest_error, 0.01);
  EXPECT_NEAR(std::log(found.variances[0] / 0.01), 0.0, 0.1);
  EXPECT_NEAR(std::log(found.variances[1] / 1.0), 0.0, 0.1);
  for (std::size_t c = 0; c < 2; ++c)
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(found.weights[c][i], made[c].weights[i], 0.01);
}

TEST(SharedGaussians, KeepTheTotalWhateverTheirNumber) {
  const Profile profile = made_of_gaussians({{{0.01, 1.0}, {0.3, 0.1}}});
  for (const int count : {1, 3, 7}) {
    const SharedGaussians found = fit_shared_gaussians(profile, true, count);
    double sum = 0.0;
    for (const double weight : found.weights[0]) sum += weight;
    EXPECT_NEAR(sum, 0.4, 1e-12) << count;
  }
}

}  // namespace
}  // namespace lamina::detail
