// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/bodies/distance_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "lamina/base/core/random.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

Vec3f random_point(Random& random, float half_side) {
  const auto along = [&] { return half_side * (2.0f * random.uniform_float() - 1.0f); };
  const float x = along(), y = along();
  return {x, y, along()};
}

/// The triangle as a fine lattice of points: slow and plain.
float nearest_of_many(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  float nearest = std::numeric_limits<float>::infinity();
  constexpr int n = 200;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const float u = static_cast<float>(i) / n, v = static_cast<float>(j) / n;
      nearest = std::min(nearest, length((1.0f - u - v) * a + u * b + v * c - p));
    }
  return nearest;
}

TEST(NearestOnTriangle, IsNearerThanAllOtherPoints) {
  Random random(3);
  for (int i = 0; i < 60; ++i) {
    const Vec3f a = random_point(random, 1), b = random_point(random, 1);
    const Vec3f c = random_point(random, 1), p = random_point(random, 2);
    const Vec2f at = nearest_on_triangle(p, a, b, c);
    EXPECT_GE(at.x, 0.0f);
    EXPECT_GE(at.y, 0.0f);
    EXPECT_LE(at.x + at.y, 1.0f + 1e-6f);
    const float distance = length((1.0f - at.x - at.y) * a + at.x * b + at.y * c - p);
    const float sought = nearest_of_many(p, a, b, c);
    EXPECT_LE(distance, sought + 1e-5f);
    EXPECT_GE(distance, sought - 0.02f);  // the lattice is that fine
  }
}

TEST(NearestOnTriangle, OfOneWithoutAreaIsOnItsLongestEdge) {
  const Vec2f at = nearest_on_triangle({0.5f, 1, 0}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0});
  EXPECT_NEAR(at.x + 2.0f * at.y, 0.5f, 1e-6f);
}

TEST(RayGeometry, ClosestPointOfABallIsAlongItsRadius) {
  const std::vector<Mesh> meshes = {make_sphere(3.0f, 64)};
  const RayGeometry geometry(meshes);
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const Vec3f p = random_point(random, 4);
    const Hit hit = geometry.closest_point(p, 100.0f);
    ASSERT_TRUE(hit.is_hit());
    const float distance = std::abs(length(p) - 3.0f);
    EXPECT_GE(hit.distance, distance - 0.01f);            // facets lie within the sphere
    EXPECT_LE(hit.distance, 1.12f * (distance + 0.01f));  // within the slack that it states
  }
  EXPECT_FALSE(geometry.closest_point({0, 0, 0}, 2.0f).is_hit());
  EXPECT_FALSE(geometry.closest_point({0, 0, 2.9f}, 2.0f, 1u).is_hit());  // no such material
}

TEST(DistanceField, IsNoLongerThanTheDistanceToTheSurface) {
  const std::vector<Mesh> meshes = {make_sphere(3.0f, 64)};
  const RayGeometry geometry(meshes);
  const NodeLattice lattice({-3, -3, -3}, {3, 3, 3}, 0.3f, 1e6);
  const DistanceField field(geometry, meshes, lattice, {{-3, -3, -3}, {3, 3, 3}, 0.6f, 1e6});
  Random random(7);
  double sum = 0.0, sum_of_true = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3f p = random_point(random, 3);
    const float distance = std::abs(3.0f - length(p));
    EXPECT_LE(field.at(p), distance + 0.005f);
    if (distance > 1.0f) continue;
    sum += static_cast<double>(std::max(field.at(p), 0.0f));
    sum_of_true += static_cast<double>(distance);
  }
  EXPECT_GT(sum, 0.4 * sum_of_true);  // and long enough to be of use
  EXPECT_GT(dot(field.nearest_normal({0, 0, 2.8f}), Vec3f{0, 0, 1}), 0.98f);
}

// Both faces are near to an edge, one to the middle of a face, none to the middle of the cube, and
// those of the nearest come first.
TEST(DistanceField, KnowsAllThatIsNear) {
  const std::vector<Mesh> meshes = {make_cube(20.0f)};
  const RayGeometry geometry(meshes);
  const Vec3f low{-10, -10, -10}, high{10, 10, 10};
  const DistanceField field(geometry, meshes, {low, high, 0.3f, 1e6}, {low, high, 0.6f, 1e6});
  const auto expect = [](const FewNormals& found, std::initializer_list<Vec3f> normals) {
    ASSERT_EQ(found.count, normals.size());
    std::size_t i = 0;
    for (const Vec3f& n : normals) EXPECT_GT(dot(found.at[i++], n), 0.99f);
  };
  expect(field.normals_near({0, 0, 9}), {{0, 0, 1}});
  expect(field.normals_near({8.5f, 0, 9}), {{0, 0, 1}, {1, 0, 0}});
  expect(field.normals_near({0, 0, 0}), {});
}

}  // namespace
}  // namespace lamina
