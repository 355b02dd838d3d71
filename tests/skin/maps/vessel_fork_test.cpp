// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/vessel_fork.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lamina {
namespace {

/// The diameter at which a flow takes the least work, found by search: pumping it takes flow^2 /
/// diameter^4 (Poiseuille), and keeping the blood diameter^2, both per length in some unit.
double cheapest_diameter(double flow) {
  const auto work = [&](double d) { return flow * flow / (d * d * d * d) + d * d; };
  double low = 1e-3, high = 10.0;
  while (high - low > 1e-9) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    (work(a) < work(b) ? high : low) = work(a) < work(b) ? b : a;
  }
  return low;
}

TEST(VesselFork, HasTheDiametersThatTakeTheLeastWork) {
  for (const double share : {0.02, 0.2, 0.35, 0.5}) {
    const VesselFork fork = split_vessel(0.6, share);
    EXPECT_NEAR(std::pow(fork.wide, 3) + std::pow(fork.narrow, 3), std::pow(0.6, 3), 1e-12);
    const double whole = cheapest_diameter(1.0);
    EXPECT_NEAR(fork.narrow / 0.6, cheapest_diameter(share) / whole, 1e-6) << share;
    EXPECT_NEAR(fork.wide / 0.6, cheapest_diameter(1.0 - share) / whole, 1e-6) << share;
  }
}

// Moved a little, a fork takes more work: threads drawn with the squares of the diameters balance.
TEST(VesselFork, StandsWhereItsVesselsTakeTheLeastWork) {
  for (const double share : {0.02, 0.2, 0.35, 0.5}) {
    const VesselFork fork = split_vessel(1.0, share);
    const double wide = fork.wide * fork.wide, narrow = fork.narrow * fork.narrow;
    EXPECT_NEAR(wide * std::cos(fork.wide_angle) + narrow * std::cos(fork.narrow_angle), 1.0,
                1e-12);
    EXPECT_NEAR(wide * std::sin(fork.wide_angle), narrow * std::sin(fork.narrow_angle), 1e-12);
    EXPECT_GT(fork.narrow_angle, 0.0);
    EXPECT_GE(fork.narrow_angle, fork.wide_angle - 1e-12);  // a twig leaves at more of an angle
  }
}

}  // namespace
}  // namespace lamina
