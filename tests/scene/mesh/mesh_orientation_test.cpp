// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/mesh_orientation.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "lamina/scene/mesh/mesh_shapes.h"

namespace lamina {
namespace {

void reverse_face(PolygonMesh& mesh, std::size_t f) {
  std::reverse(mesh.corners.begin() + mesh.face_begin[f],
               mesh.corners.begin() + mesh.face_begin[f + 1]);
}

PolygonMesh without_normals(PolygonMesh mesh) {
  mesh.normals.clear();
  for (MeshCorner& corner : mesh.corners) corner.normal = no_index;
  unify_indices(mesh);
  return mesh;
}

PolygonMesh unified(PolygonMesh mesh) {
  unify_indices(mesh);
  return mesh;
}

/// Faces of a shape around the origin that look away from it.
std::size_t outward_faces(const PolygonMesh& mesh) {
  std::size_t count = 0;
  for (std::size_t f = 0; f < face_count(mesh); ++f) {
    const Vec3f& p = mesh.positions[face(mesh, f)[0].position];
    if (dot(Vec3{p.x, p.y, p.z}, doubled_area(mesh, f)) > 0.0) ++count;
  }
  return count;
}

PolygonMesh join(PolygonMesh a, const PolygonMesh& b) {
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (std::size_t f = 0; f < face_count(b); ++f) {
    std::vector<MeshCorner> corners(face(b, f).begin(), face(b, f).end());
    for (MeshCorner& corner : corners) corner = {.position = corner.position + first};
    add_face(a, corners, 0);
  }
  return a;
}

TEST(Orientation, LeavesASoundMeshAlone) {
  for (const PolygonMesh& shape :
       {make_sphere(1, 8), make_box({1, 2, 3}, 3), make_bumpy_sphere(1, 9)}) {
    const OrientedMesh oriented = orient_mesh(unified(shape));
    EXPECT_EQ(oriented.turned_faces + oriented.inside_out + oriented.turned_normals, 0U);
    EXPECT_TRUE(oriented.is_closed);
    EXPECT_EQ(outward_faces(oriented.mesh), face_count(shape)) << shape.name;
  }
  EXPECT_FALSE(orient_mesh(unified(make_rectangle(1, 1, 3))).is_closed);
}

TEST(Orientation, TurnsFacesThatAreWoundAgainstTheirNeighbours) {
  PolygonMesh sphere = without_normals(make_sphere(1, 8));
  for (const std::size_t f : {3U, 20U, 77U}) reverse_face(sphere, f);
  const OrientedMesh oriented = orient_mesh(sphere);
  EXPECT_EQ(oriented.turned_faces, 3U);
  EXPECT_EQ(oriented.inside_out, 0U);
  EXPECT_EQ(outward_faces(oriented.mesh), face_count(sphere));
}

TEST(Orientation, TurnsAClosedSurfaceThatIsInsideOut) {
  PolygonMesh sphere = without_normals(make_sphere(1, 8));
  for (std::size_t f = 0; f < face_count(sphere); ++f)
    if (f != 5) reverse_face(sphere, f);
  const OrientedMesh oriented = orient_mesh(sphere);
  EXPECT_EQ(oriented.inside_out, 1U);
  EXPECT_EQ(oriented.turned_faces, 1U);  // the one that disagreed with the rest
  EXPECT_EQ(outward_faces(oriented.mesh), face_count(sphere));
}

TEST(Orientation, LeavesTheInnerWallOfAHollowBody) {
  PolygonMesh inner = without_normals(make_sphere(0.5, 6));
  for (std::size_t f = 0; f < face_count(inner); ++f) reverse_face(inner, f);
  const OrientedMesh oriented = orient_mesh(join(without_normals(make_sphere(1, 8)), inner));
  EXPECT_EQ(oriented.inside_out, 0U);
  EXPECT_EQ(outward_faces(oriented.mesh), face_count(make_sphere(1, 8)));
}

TEST(Orientation, AnOpenSurfaceFollowsItsNormals) {
  PolygonMesh sheet = unified(make_rectangle(1, 1, 4));
  for (std::size_t f = 0; f < face_count(sheet); ++f) reverse_face(sheet, f);
  const OrientedMesh oriented = orient_mesh(sheet);
  EXPECT_EQ(oriented.turned_faces, 16U);
  EXPECT_EQ(oriented.turned_normals, 0U);
  for (std::size_t f = 0; f < 16; ++f) EXPECT_GT(doubled_area(oriented.mesh, f).z, 0.0);
}

TEST(Orientation, TurnsNormalsThatPointToTheBack) {
  PolygonMesh sphere = unified(make_sphere(1, 8));
  for (Vec3f& n : sphere.normals) n = -n;
  const OrientedMesh oriented = orient_mesh(sphere);
  EXPECT_EQ(oriented.turned_normals, face_count(sphere));
  EXPECT_EQ(oriented.inside_out, 0U);
  for (const MeshCorner& corner : oriented.mesh.corners)
    EXPECT_GT(dot(oriented.mesh.normals[corner.normal], oriented.mesh.positions[corner.position]),
              0.0F);
}

TEST(Orientation, AMoebiusStripHasNoOutsideAndStaysWhole) {
  PolygonMesh strip;
  strip.parts = {{}};
  constexpr std::uint32_t n = 12;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double phi = 2.0 * std::acos(-1.0) * i / n;
    for (const double side : {-0.3, 0.3}) {
      const double r = 1.0 + side * std::cos(phi / 2.0);
      strip.positions.push_back({static_cast<float>(r * std::cos(phi)),
                                 static_cast<float>(r * std::sin(phi)),
                                 static_cast<float>(side * std::sin(phi / 2.0))});
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 * i, b = (2 * i + 2) % (2 * n), twist = i + 1 == n ? 1 : 0;
    const MeshCorner corners[] = {
        {.position = a}, {.position = a + 1}, {.position = b + 1 - twist}, {.position = b + twist}};
    add_face(strip, corners, 0);
  }
  const OrientedMesh oriented = orient_mesh(strip);
  EXPECT_EQ(face_count(oriented.mesh), n);
  EXPECT_FALSE(oriented.is_closed);
}

}  // namespace
}  // namespace lamina
