// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/surface_points.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "render/small_scenes.h"

namespace lamina {
namespace {

TEST(SurfacePoints, AreTheSameInWhateverOrderTheyCome) {
  std::vector<SurfacePoint> all(1000);
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i].position = {static_cast<float>(i * 37 % 100), static_cast<float>(i / 100), 0.0f};
  const auto some = some_of(all, 64);
  std::ranges::reverse(all);
  const auto others = some_of(all, 64);
  ASSERT_EQ(some.size(), 64u);
  ASSERT_EQ(others.size(), 64u);
  float low = 100.0f, high = 0.0f;
  for (std::size_t i = 0; i < some.size(); ++i) {
    EXPECT_EQ(some[i].position.x, others[i].position.x) << i;
    EXPECT_EQ(some[i].position.y, others[i].position.y) << i;
    low = std::min(low, some[i].position.x);
    high = std::max(high, some[i].position.x);
  }
  EXPECT_LT(low, 5.0f);
  EXPECT_GT(high, 95.0f);
  EXPECT_EQ(some_of(all, 5000).size(), all.size());
  EXPECT_TRUE(some_of({}, 64).empty());
}

TEST(SurfacePoints, LieEvenlyOverABall) {
  Scene scene;
  scene.meshes = {make_sphere(2.0f, 64)};
  const auto points = points_all_over(scene, 0, 1000);
  EXPECT_GT(points.size(), 700u);
  EXPECT_LT(points.size(), 1400u);
  Vec3f sum;
  for (const SurfacePoint& point : points) {
    EXPECT_NEAR(length(point.position), 2.0f, 0.01f);
    sum += point.position;
  }
  EXPECT_LT(length(sum) / static_cast<float>(points.size()), 0.2f);
}

}  // namespace
}  // namespace lamina
