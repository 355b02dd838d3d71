// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/direction_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace lamina {
namespace {

const std::vector<double> indices = {1.4, 1.0, 1.34, 1.4, 1.0};

TEST(DirectionGrid, EtendueOfAMediumIsItsIndexSquared) {
  const DirectionGrid grid = make_direction_grid(indices, 8);
  for (const double ior : {1.0, 1.34, 1.4}) {
    const auto end = grid.etendue.begin() + static_cast<std::ptrdiff_t>(active_count(grid, ior));
    EXPECT_NEAR(std::accumulate(grid.etendue.begin(), end, 0.0), ior * ior, 1e-13);
  }
}

TEST(DirectionGrid, CosineObeysSnellsLaw) {
  const std::vector<double> extra = {0.0, 0.5, 1.2};
  const DirectionGrid grid = make_direction_grid(indices, 8, extra);
  for (const double ior : {1.0, 1.34, 1.4})
    for (std::size_t i = 0; i < active_count(grid, ior); ++i) {
      ASSERT_LT(grid.p[i], ior);
      const double sin = grid.p[i] / ior;
      EXPECT_NEAR(cosine(grid, i, ior), std::sqrt(1.0 - sin * sin), 1e-12);
    }
}

TEST(DirectionGrid, ExtraDirectionsAreFoundWhereTheyBelong) {
  const std::vector<double> extra = {1.2, 0.0, 1.0, 1.39};
  const DirectionGrid grid = make_direction_grid(indices, 4, extra);
  for (std::size_t k = 0; k < extra.size(); ++k) EXPECT_EQ(grid.p[grid.extra[k]], extra[k]);
  EXPECT_LT(grid.extra[1], active_count(grid, 1.0));
  EXPECT_GE(grid.extra[2], active_count(grid, 1.0));  // grazing is not inside
  EXPECT_GE(grid.extra[3], active_count(grid, 1.34));
}

// The kink of Fresnel's law at a critical angle is between two segments: 8 nodes give 1e-6, where a
// rule across the kink gives 1e-3.
TEST(DirectionGrid, IntegratesAcrossACriticalAngle) {
  const auto kinked = [](double p) { return p < 1.34 ? std::sqrt(1.34 * 1.34 - p * p) : 0.0; };
  const double exact = 2.0 / 3.0 * std::pow(1.34, 3);
  const DirectionGrid grid = make_direction_grid(indices, 8);
  double sum = 0.0;
  for (std::size_t i = 0; i < grid.size(); ++i) sum += grid.etendue[i] * kinked(grid.p[i]);
  EXPECT_NEAR(sum, exact, 1e-6);
}

}  // namespace
}  // namespace lamina
