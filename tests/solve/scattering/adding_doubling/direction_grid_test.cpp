// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/direction_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
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

/// A direction of the medium of index 1.4.
GridDirection direction_of(double p) {
  return {1.4, p / 1.4, std::sqrt((1.0 - p / 1.4) * (1.0 + p / 1.4))};
}

TEST(DirectionGrid, CosineObeysSnellsLaw) {
  const std::vector<GridDirection> extra = {direction_of(0.0), direction_of(0.5),
                                            direction_of(1.2)};
  const DirectionGrid grid = make_direction_grid(indices, 8, extra);
  for (const double ior : {1.0, 1.34, 1.4})
    for (std::size_t i = 0; i < active_count(grid, ior); ++i) {
      ASSERT_LT(grid.p[i], ior);
      const double sin = grid.p[i] / ior;
      EXPECT_NEAR(cosine(grid, i, ior), std::sqrt(1.0 - sin * sin), 1e-12);
    }
}

TEST(DirectionGrid, ExtraDirectionsAreFoundWhereTheyBelong) {
  const std::vector<double> p = {1.2, 0.0, 1.0, 1.39};
  std::vector<GridDirection> extra;
  for (const double each : p) extra.push_back(direction_of(each));
  const DirectionGrid grid = make_direction_grid(indices, 4, extra);
  for (std::size_t k = 0; k < p.size(); ++k) EXPECT_DOUBLE_EQ(grid.p[grid.extra[k]], p[k]);
  EXPECT_LT(grid.extra[1], active_count(grid, 1.0));
  EXPECT_GE(grid.extra[2], active_count(grid, 1.0));  // grazing is not inside
  EXPECT_GE(grid.extra[3], active_count(grid, 1.34));
}

// Its sine is 1 to the last digit, yet it goes down and has a cosine.
TEST(DirectionGrid, GrazingDirectionsBelongToTheirMedium) {
  for (const double from_grazing : {1e-6, 1e-8, 5e-9}) {
    const std::vector<GridDirection> extra = {
        direction_in(1.0, 0.5 * std::numbers::pi - from_grazing)};
    const DirectionGrid grid = make_direction_grid(indices, 4, extra);
    EXPECT_LT(grid.extra[0], active_count(grid, 1.0));
    EXPECT_NEAR(cosine(grid, grid.extra[0], 1.0), from_grazing, 1e-7 * from_grazing);
    EXPECT_NEAR(cosine(grid, grid.extra[0], 1.4), std::sqrt(1.0 - 1.0 / 1.96), 1e-12);
  }
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
