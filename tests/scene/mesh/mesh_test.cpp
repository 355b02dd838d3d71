// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/mesh.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/random.h"
#include "lamina/scene/mesh/files/mesh_file.h"
#include "lamina/scene/mesh/mesh_shapes.h"
#include "lamina/scene/mesh/mesh_triangulation.h"
#include "scene/mesh/mesh_samples.h"

namespace lamina {
namespace {

constexpr std::uint32_t one_material[] = {0};

double area(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += 0.5 * length(cross(to_double(mesh.positions[b] - mesh.positions[a]),
                              to_double(mesh.positions[c] - mesh.positions[a])));
  return sum;
}

double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += dot(to_double(mesh.positions[a]),
               cross(to_double(mesh.positions[b]), to_double(mesh.positions[c]))) /
           6.0;
  return sum;
}

PreparedMesh prepare(PolygonMesh polygons, const MeshOptions& options = {}) {
  return make_mesh(std::move(polygons), options, one_material);
}

TEST(Shapes, HaveTheirAreasAndVolumes) {
  EXPECT_NEAR(area(prepare(make_rectangle(2, 3, 5)).mesh), 6.0, 1e-5);
  const Mesh box = prepare(make_box({1, 2, 3}, 4)).mesh;
  EXPECT_NEAR(area(box), 22.0, 1e-4);
  EXPECT_NEAR(volume(box), 6.0, 1e-4);
  // An inscribed regular polygon: n/2 sin(2 pi / n).
  EXPECT_NEAR(area(prepare(make_disk(2, 48)).mesh), 4.0 * 24.0 * std::sin(std::numbers::pi / 24.0),
              1e-4);
  const Mesh sphere = prepare(make_sphere(2, 64)).mesh;  // 1 - O(1 / n²) of the sphere
  EXPECT_NEAR(area(sphere) / (16.0 * std::numbers::pi), 1.0, 1.5e-3);
  EXPECT_NEAR(volume(sphere) / (32.0 / 3.0 * std::numbers::pi), 1.0, 2e-3);
}

TEST(Shapes, NormalsAndTextureCoordinatesAreThereAndVerticesAreShared) {
  const Mesh box = prepare(make_box({1, 1, 1}, 1)).mesh;
  EXPECT_EQ(box.positions.size(), 24U);
  EXPECT_EQ(box.triangles.size(), 12U);
  EXPECT_TRUE(box.is_closed);
  const Mesh sphere = prepare(make_sphere(1, 8)).mesh;
  // Rows of 16 columns plus the seam's double; at each pole one vertex per column.
  EXPECT_EQ(sphere.positions.size(), 7U * 17U + 2U * 16U);
  for (std::size_t i = 0; i < sphere.positions.size(); ++i)
    EXPECT_LT(length(sphere.positions[i] - sphere.normals[i]), 1e-6F);
  // Seen from +z the texture reads from left to right and upward.
  for (std::size_t i = 0; i < sphere.positions.size(); ++i)
    if (length(sphere.positions[i] - Vec3f{0, 0, 1}) < 1e-6F) {
      EXPECT_LT(length(Vec3f{sphere.uvs[i].x - 0.5F, sphere.uvs[i].y - 0.5F, 0}), 1e-6F);
    }
}

TEST(Shapes, BumpySphereHasItsMeanRadiusAndExactNormals) {
  const Mesh mesh = prepare(make_bumpy_sphere(10, 50)).mesh;
  EXPECT_EQ(mesh.triangles.size(), 30'000U);
  EXPECT_TRUE(mesh.is_closed);
  // The mean radius over directions, from the solid angle of each triangle.
  double sum = 0.0, solid_angles = 0.0, least = 1e9, most = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = to_double(mesh.positions[a]), q = to_double(mesh.positions[b]),
               r = to_double(mesh.positions[c]);
    const Vec3 u = normalize(p), v = normalize(q), w = normalize(r);
    const double omega =
        2.0 * std::atan2(dot(u, cross(v, w)), 1.0 + dot(u, v) + dot(v, w) + dot(w, u));
    sum += omega * (length(p) + length(q) + length(r)) / 3.0;
    solid_angles += omega;
    least = std::min(least, length(p)), most = std::max(most, length(p));
  }
  EXPECT_NEAR(solid_angles, 4.0 * std::numbers::pi, 1e-5);
  EXPECT_NEAR(sum / solid_angles, 10.0, 5e-3);  // of the order of 1 / tessellation²
  EXPECT_GT(least, 7.0);
  EXPECT_LT(most, 13.0);
  EXPECT_GT(most - least, 3.0);  // bumpy
}

// The normals of the formula against the mean of the faces around, which is right to first order in
// the size of the faces where the grid bends, at the edges of the cube that it comes from.
TEST(Shapes, BustIsClosedAndOfItsHeightAtAnyTessellation) {
  for (const int tessellation : {16, 37, 96}) {
    const PreparedMesh prepared = prepare(make_bust(10, tessellation));
    EXPECT_TRUE(prepared.mesh.is_closed) << tessellation;
    EXPECT_TRUE(prepared.warnings.empty()) << prepared.warnings.front();
    float low = 100.0F, high = -100.0F;
    for (const Vec3f& p : prepared.mesh.positions) {
      low = std::min(low, p.y);
      high = std::max(high, p.y);
    }
    EXPECT_NEAR(high - low, 10.0F, tessellation < 90 ? 0.5F : 0.05F);
    EXPECT_NEAR(high + low, 0.0F, 0.5F);
  }
}

TEST(Shapes, NormalsOfTheBumpySphereAreThoseOfItsSurface) {
  const auto largest_angle = [](int tessellation) {
    PolygonMesh shape = make_bumpy_sphere(10, tessellation);
    for (MeshCorner& corner : shape.corners) corner.uv = no_index;
    const Mesh exact = prepare(shape).mesh;
    const Mesh smooth = prepare(shape, {.normals = NormalSource::smooth}).mesh;
    EXPECT_EQ(exact.positions, smooth.positions);
    float largest = 0.0F;
    for (std::size_t i = 0; i < exact.normals.size(); ++i)
      largest = std::max(largest, length(cross(exact.normals[i], smooth.normals[i])));
    return largest;
  };
  const float coarse = largest_angle(50), fine = largest_angle(100);
  EXPECT_LT(coarse, 0.03F);
  EXPECT_LT(fine, 0.6F * coarse);
}

TEST(MeshPreparation, SmoothNormalsOfASphereAreRadial) {
  PolygonMesh sphere = make_sphere(1, 24);
  sphere.normals.clear();
  for (MeshCorner& corner : sphere.corners) corner.normal = no_index;
  const Mesh mesh = prepare(sphere).mesh;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    EXPECT_GT(dot(mesh.positions[i], mesh.normals[i]), std::cos(0.01F));
}

TEST(MeshPreparation, NormalsCanBeFlatOrSmoothWhateverTheFileSays) {
  const Mesh smooth = prepare(make_box({1, 1, 1}, 1), {.normals = NormalSource::smooth}).mesh;
  const float third = 1.0F / std::sqrt(3.0F);
  for (std::size_t i = 0; i < smooth.positions.size(); ++i)
    EXPECT_NEAR(std::abs(smooth.normals[i].x), third, 1e-6F);
  const Mesh flat = prepare(make_sphere(1, 4), {.normals = NormalSource::flat}).mesh;
  for (const auto& [a, b, c] : flat.triangles) {
    EXPECT_EQ(flat.normals[a], flat.normals[b]);
    EXPECT_EQ(flat.normals[a], flat.normals[c]);
  }
}

TEST(MeshPreparation, MirrorsKeepTheOutsideOutside) {
  const Transform mirror{.x_axis = {-2, 0, 0}, .translation = {10, 0, 0}};
  PreparedMesh mirrored = prepare(make_box({1, 1, 1}, 2), {.to_world = mirror});
  EXPECT_TRUE(mirrored.warnings.empty());
  for (Vec3f& p : mirrored.mesh.positions) p = p - Vec3f{10, 0, 0};
  EXPECT_NEAR(volume(mirrored.mesh), 2.0, 1e-5);
}

TEST(MeshPreparation, NormalsStayPerpendicularUnderUnequalScales) {
  const Transform stretch{.x_axis = {5, 0, 0}, .y_axis = {1, 1, 0}};
  const Mesh mesh = prepare(make_sphere(1, 96), {.to_world = stretch}).mesh;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3f n = normalize(
        cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
    EXPECT_GT(dot(n, mesh.normals[b]), 0.98F);
  }
}

TEST(MeshPreparation, WarnsOfWhatItMends) {
  PolygonMesh mesh = parse_obj(
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nvn 0 0 -1\nvn 0 0 0\nvt 0 0\n"
      "f 1//1 2//1 3//1\nf 1/1/2 3/1/2 4/1/2\nf 1 2 5\nf 1 1 2\n",
      "f.obj");
  const std::vector<std::uint32_t> materials(mesh.parts.size());
  const PreparedMesh prepared = make_mesh(mesh, {}, materials);
  EXPECT_EQ(prepared.mesh.triangles.size(), 2U);
  EXPECT_EQ(
      prepared.warnings,
      (std::vector<std::string>{
          "f.obj: 2 faces of zero area are dropped",
          "f.obj: 2 faces without texture coordinates have (0, 0) among others that have them",
          "f.obj: 1 normal without a direction is replaced by the mean of the faces around",
          "f.obj: 2 faces wound the wrong way are turned"}));
}

TEST(MeshPreparation, RefusesAMeshWithoutArea) {
  const PolygonMesh flat = parse_obj("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 2\n", "f.obj");
  EXPECT_EQ(message_of([&] { (void)prepare(flat); }),
            "f.obj: must have a surface, but all its faces (2) have zero area");
}

TEST(MeshPreparation, RefusesPositionsThatLoseAllMeaning) {
  EXPECT_NE(message_of([&] {
              (void)prepare(make_box({1, 1, 1}, 1), {.to_world = {.translation = {1e12, 0, 0}}});
            }).find("mm, where numbers of single precision are "),
            std::string::npos);
  EXPECT_EQ(message_of([&] {
              (void)prepare(make_box({1e10, 1, 1}, 1));
            }).find("box: vertex 0 must lie within 1e9 mm of the origin, but has a coordinate"),
            0U);
  EXPECT_EQ(message_of([&] {
              (void)prepare(make_box({1, 1, 1}, 1), {.to_world = {.y_axis = {1, 0, 0}}});
            }),
            "box: its transform must not flatten it");
}

// The parts of any simple polygon have its area, none turned over: here stars around a point, in a
// plane of any direction.
RC_GTEST_PROP(Triangulation, CutsStarShapedPolygonsIntoTrianglesOfTheSameArea,
              (std::uint32_t seed)) {
  Random random = make_random(5, seed);
  const auto count = 3 + random.bits() % 40;
  const Frame plane = make_frame(
      normalize(Vec3{random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5}));
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double phi = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    const double r = 0.1 + random.uniform();
    points.push_back(plane.to_world({r * std::cos(phi), r * std::sin(phi), 0.0}));
  }
  Vec3 whole, sum;
  double positive = 0.0;
  for (std::size_t i = 1; i + 1 < count; ++i)
    whole += cross(points[i] - points[0], points[i + 1] - points[0]);
  const auto triangles = triangulate(points);
  RC_ASSERT(triangles.size() == count - 2);
  for (const auto& [a, b, c] : triangles) {
    const Vec3 part = cross(points[b] - points[a], points[c] - points[a]);
    sum += part;
    positive += std::abs(dot(part, plane.z));
  }
  RC_ASSERT(length(sum - whole) < 1e-12);
  RC_ASSERT(std::abs(positive - dot(whole, plane.z)) < 1e-12);  // none turned over, none overlaps
}

TEST(Triangulation, CutsADartAtItsHollowCorner) {
  const Vec3 dart[] = {{0, 0, 0}, {2, -1, 0}, {0.5, 0, 0}, {2, 1, 0}};
  for (std::size_t shift = 0; shift < 4; ++shift) {
    std::vector<Vec3> points(dart, dart + 4);
    std::ranges::rotate(points, points.begin() + static_cast<std::ptrdiff_t>(shift));
    for (const auto& [a, b, c] : triangulate(points))
      EXPECT_GT(cross(points[b] - points[a], points[c] - points[a]).z, 0.0);
  }
}

}  // namespace
}  // namespace lamina
