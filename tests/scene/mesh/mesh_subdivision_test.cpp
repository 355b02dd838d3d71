// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/mesh_subdivision.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lamina/scene/mesh/mesh_edges.h"
#include "lamina/scene/mesh/mesh_shapes.h"
#include "scene/mesh/mesh_samples.h"

namespace lamina {
namespace {

PolygonMesh unified(PolygonMesh mesh) {
  unify_indices(mesh);
  return mesh;
}

double distance(const Vec3f& a, const Vec3f& b) { return static_cast<double>(length(a - b)); }

bool has_position(const PolygonMesh& mesh, const Vec3f& p) {
  return std::ranges::any_of(mesh.positions, [&](const Vec3f& q) { return distance(p, q) < 1e-6; });
}

// Worked by hand from the rules of [CatmullClark1978] for the cube [-1, 1]³.
TEST(CatmullClark, OneStepOfTheCube) {
  const PolygonMesh cube = unified(make_box({2, 2, 2}, 1));
  ASSERT_EQ(cube.positions.size(), 8U);
  const PolygonMesh once = subdivide_catmull_clark(cube, 1);
  EXPECT_EQ(face_count(once), 24U);
  EXPECT_EQ(once.positions.size(), 26U);
  constexpr float vertex = 5.0F / 9.0F;
  EXPECT_TRUE(has_position(once, {vertex, vertex, -vertex}));
  EXPECT_TRUE(has_position(once, {0.75F, 0.75F, 0}));
  EXPECT_TRUE(has_position(once, {0, 0, 1}));
}

// The limit of a regular grid is the bicubic B-spline of its points: x(s) of uniform knots is
// reproduced for cubic polynomials of the surface up to known shifts. For heights z = x² the cubic
// B-spline with these control values is z = x² + 1/3 (in units of the grid).
TEST(CatmullClark, LimitOfAGridIsTheCubicBSpline) {
  PolygonMesh grid = make_rectangle(8, 8, 8);
  for (Vec3f& p : grid.positions) p.z = p.x * p.x;
  const PolygonMesh fine = subdivide_catmull_clark(unified(grid), 4);
  int checked = 0;
  for (const Vec3f& p : fine.positions) {
    if (std::abs(p.x) > 2.0F || std::abs(p.y) > 2.0F) continue;
    // After k steps the control points are 1/3 / 4^k above the curve.
    EXPECT_NEAR(p.z, p.x * p.x + (1.0F - 1.0F / 256.0F) / 3.0F, 2e-6F);
    ++checked;
  }
  EXPECT_GT(checked, 1000);
}

TEST(CatmullClark, BordersAreCurvesOfTheirOwnAndCornersStay) {
  PolygonMesh grid = unified(make_rectangle(4, 4, 4));
  const PolygonMesh fine = subdivide_catmull_clark(grid, 3);
  for (const float x : {-2.0F, 2.0F})
    for (const float y : {-2.0F, 2.0F}) EXPECT_TRUE(has_position(fine, {x, y, 0}));
  for (const Vec3f& p : fine.positions)
    EXPECT_TRUE(std::abs(p.x) <= 2.0F && std::abs(p.y) <= 2.0F && p.z == 0.0F);
}

TEST(CatmullClark, CommutesWithAffineMaps) {
  const Transform map{{1, 2, 0}, {0, 1, -1}, {0.5, 0, 2}, {3, 4, 5}};
  const PolygonMesh shape = unified(make_bumpy_sphere(2.0, 3));
  PolygonMesh before = shape, after = subdivide_catmull_clark(shape, 2);
  transform_mesh(map, before);
  before = subdivide_catmull_clark(before, 2);
  transform_mesh(map, after);
  ASSERT_EQ(before.positions.size(), after.positions.size());
  for (std::size_t i = 0; i < after.positions.size(); ++i)
    EXPECT_LT(distance(before.positions[i], after.positions[i]), 2e-5);
}

TEST(CatmullClark, KeepsClosedSurfacesClosedAndTheirEulerCharacteristic) {
  for (int levels : {0, 1, 2}) {
    const PolygonMesh mesh = subdivide_catmull_clark(unified(make_sphere(1.0, 5)), levels);
    std::vector<std::uint32_t> vertices;
    for (const MeshCorner& corner : mesh.corners) vertices.push_back(corner.position);
    const MeshEdges edges = make_mesh_edges(mesh.face_begin, vertices, mesh.positions.size());
    for (const MeshEdge& edge : edges.edges) EXPECT_EQ(edge.face_count, 2U);
    EXPECT_EQ(static_cast<long>(mesh.positions.size()) - static_cast<long>(edges.edges.size()) +
                  static_cast<long>(face_count(mesh)),
              2);
  }
}

// A cylinder whose texture runs u = angle, v = height, cut at one meridian.
TEST(CatmullClark, SeamsOfTheTextureStaySharpAndMeet) {
  constexpr int n = 8;
  PolygonMesh tube;
  tube.parts = {{}};
  for (std::uint32_t j = 0; j <= 4; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double phi = 2.0 * std::acos(-1.0) * (i % n) / n;
      tube.positions.push_back({static_cast<float>(std::cos(phi)),
                                static_cast<float>(std::sin(phi)), static_cast<float>(j)});
      tube.uvs.push_back({static_cast<float>(i) / n, static_cast<float>(j) / 4});
    }
  for (std::uint32_t j = 0; j < 4; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t v = j * (n + 1) + i;
      std::vector<MeshCorner> corners;
      for (const std::uint32_t w : {v, v + 1, v + n + 2, v + n + 1})
        corners.push_back({.position = w, .uv = w});
      add_face(tube, corners, 0);
    }
  unify_indices(tube);
  EXPECT_EQ(tube.positions.size(), 5U * n);
  EXPECT_EQ(tube.uvs.size(), 5U * (n + 1));
  const PolygonMesh fine = subdivide_catmull_clark(tube, 2);
  int on_seam = 0;
  for (const MeshCorner& corner : fine.corners) {
    const Vec3f& p = fine.positions[corner.position];
    const Vec2f& uv = fine.uvs[corner.uv];
    // The texture of every point follows its angle; linear in it, as it began. Chords, and rows
    // near the seam, deviate by less than a tenth of a face.
    double angle =
        std::atan2(static_cast<double>(p.y), static_cast<double>(p.x)) / (2.0 * std::acos(-1.0));
    if (angle < -1e-6) angle += 1.0;
    const double off = std::abs(angle - static_cast<double>(uv.x));
    EXPECT_LT(std::min(off, 1.0 - off), 0.1 / n);
    if (std::abs(p.y) < 1e-6F && p.x > 0.0F) {
      EXPECT_TRUE(uv.x < 1e-6F || uv.x > 1.0F - 1e-6F);  // one side or the other, exactly
      ++on_seam;
    }
  }
  EXPECT_EQ(on_seam, 2 * 2 * 16);  // two faces on each side of the 16 edges of the finer seam
}

TEST(CatmullClark, RefusesToFillTheMemory) {
  PolygonMesh grid = unified(make_rectangle(1, 1, 400));
  EXPECT_EQ(
      message_of([&] { (void)subdivide_catmull_clark(grid, 6); }),
      "rectangle: 160000 faces, subdivided 6 times, must not give more than 100 million faces");
}

/// The cube [-1, 1]³ with sharp edges around its top, z = 1.
PolygonMesh creased_cube(float sharpness) {
  PolygonMesh cube = unified(make_box({2, 2, 2}, 1));
  for (std::uint32_t a = 0; a < 8; ++a)
    for (std::uint32_t b = a + 1; b < 8; ++b)
      if (cube.positions[a].z == 1.0F && cube.positions[b].z == 1.0F &&
          length(cube.positions[a] - cube.positions[b]) == 2.0F)
        cube.creases.push_back({a, b, sharpness});
  return cube;
}

// [DeRose1998] §3: a crease is a cubic B-spline of its own. By hand: its vertices go to
// 3/4 (1, 1) + 1/8 ((-1, 1) + (1, -1)) = (3/4, 3/4), its edge points to the middles.
TEST(Creases, AreCubicBSplinesInTheirPlane) {
  ASSERT_EQ(creased_cube(1).creases.size(), 4U);
  const PolygonMesh once = subdivide_catmull_clark(creased_cube(1), 1);
  EXPECT_TRUE(has_position(once, {0.75F, 0.75F, 1}));
  EXPECT_TRUE(has_position(once, {1, 0, 1}));
  constexpr float vertex = 5.0F / 9.0F;
  EXPECT_TRUE(has_position(once, {vertex, vertex, -vertex}));  // the smooth corner below
  EXPECT_FALSE(has_position(once, {vertex, vertex, vertex}));
  // With a sharpness of 5 the rim stays in the plane for five steps; after one it is rounded.
  const auto reach_of_top = [](float sharpness) {
    float reach = 0.0F;
    for (const Vec3f& p : subdivide_catmull_clark(creased_cube(sharpness), 5).positions)
      if (p.z > 0.9999F) reach = std::max(reach, p.x);
    return reach;
  };
  // The curve of a square's corners passes (23 + 23 - 1 - 1) / 48 in the middle of its sides.
  EXPECT_NEAR(reach_of_top(5), 11.0F / 12.0F, 5e-4F);
  EXPECT_LT(reach_of_top(1), 0.8F);
}

TEST(Creases, OfAFractionAreTheMeanOfSmoothAndSharp) {
  const PolygonMesh once = subdivide_catmull_clark(creased_cube(0.25F), 1);
  constexpr float smooth = 5.0F / 9.0F;
  EXPECT_TRUE(has_position(once, {0.75F * smooth + 0.25F * 0.75F, 0.75F * smooth + 0.25F * 0.75F,
                                  0.75F * smooth + 0.25F}));
  EXPECT_TRUE(has_position(once, {0.75F * 0.75F + 0.25F, 0, 0.75F * 0.75F + 0.25F}));
}

TEST(Creases, OfAllEdgesKeepAPolyhedron) {
  const PolygonMesh fine =
      subdivide_catmull_clark(unified(make_box({2, 2, 2}, 1)), 3, {.angle = 1.0});
  for (const float x : {-1.0F, 1.0F})
    for (const float y : {-1.0F, 1.0F})
      for (const float z : {-1.0F, 1.0F}) EXPECT_TRUE(has_position(fine, {x, y, z}));
  for (const Vec3f& p : fine.positions)
    EXPECT_EQ(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 1.0F);
  const PolygonMesh smooth =
      subdivide_catmull_clark(unified(make_box({2, 2, 2}, 1)), 3, {.angle = 1.6});
  EXPECT_FALSE(has_position(smooth, {1, 1, 1}));  // a right angle is less
}

}  // namespace
}  // namespace lamina
