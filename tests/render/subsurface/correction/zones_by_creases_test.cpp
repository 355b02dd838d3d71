// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/correction/internal/zones_by_creases.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "lamina/render/subsurface/correction/internal/place_graph.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

TEST(ZonesByCreases, FollowTheDistanceToTheEdgesOfACube) {
  const ZonesByCreases zones({make_cube(20.0f)}, 0, 1.0f);
  EXPECT_NEAR(zones.at({10, 10, 3}), 0.0f, 0.1f);  // on an edge
  for (const float d : {0.5f, 1.0f, 2.0f})
    EXPECT_NEAR(zones.at({10.0f - d, 4, 10}), std::log1p(4.0f * d), 0.05f) << d;
  EXPECT_FLOAT_EQ(zones.at({10, 0, 0}), std::log1p(16.0f));
}

TEST(ZonesByCreases, AreOneWhereNothingIsSharp) {
  const ZonesByCreases zones({make_sphere(3.0f)}, 0, 0.2f);
  for (const Vec3f& p : {Vec3f{3, 0, 0}, {0, 0, 3}, {0, 2.1f, 2.1f}})
    EXPECT_FLOAT_EQ(zones.at(p), std::log1p(16.0f));
  EXPECT_FLOAT_EQ(ZonesByCreases({make_cube(2.0f)}, 1, 0.2f).at({1, 1, 0}), std::log1p(16.0f));
}

TEST(PlaceGraph, MixesLittleBetweenZones) {
  const Vec3f up{0, 0, 1};
  const std::array<PlaceGraph::Place, 3> places = {{{{{0, 0, 0}, up}, 1.0f, 0.0f},
                                                    {{{0, 1, 0}, up}, 1.0f, 0.0f},
                                                    {{{1, 0, 0}, up}, 1.0f, 1.0f}}};
  const std::vector<float> spread = PlaceGraph(places).spread(std::vector{1.0f, 0.0f, 0.0f});
  EXPECT_GT(spread[1], 0.1f);
  EXPECT_LT(spread[2], 0.001f);
  EXPECT_NEAR(spread[0] + spread[1] + spread[2], 1.0f, 1e-6f);
}

}  // namespace
}  // namespace lamina
