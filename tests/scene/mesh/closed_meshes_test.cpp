// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Which meshes are closed, as programs and scanners of other people leave them: lathes, surfaces
// that touch themselves, bowls.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/files/mesh_file.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/mesh/mesh_orientation.h"
#include "lamina/scene/mesh/mesh_report.h"
#include "lamina/scene/mesh/mesh_shapes.h"
#include "scene/mesh/mesh_samples.h"

namespace lamina {
namespace {

/// Half circles turned about the y axis, as programs make lathes: each profile has a pole of its
/// own, whose coordinates differ in their last bits.
PolygonMesh lathe(int sectors, bool is_reversed, bool has_upper_cap = true) {
  constexpr int rings = 8;
  PolygonMesh mesh;
  mesh.name = "lathe";
  mesh.parts = {{}};
  for (int i = 0; i <= sectors; ++i)
    for (int j = 0; j <= rings; ++j) {
      const double phi = 2.0 * std::numbers::pi * i / sectors, theta = std::numbers::pi * j / rings;
      mesh.positions.push_back({static_cast<float>(2 * std::sin(theta) * std::cos(phi)),
                                static_cast<float>(2 * std::cos(theta)),
                                static_cast<float>(2 * std::sin(theta) * std::sin(phi))});
    }
  for (int i = 0; i < sectors; ++i)
    for (int j = has_upper_cap ? 0 : 1; j < rings; ++j) {
      const auto at = [&](int a, int b) {
        return MeshCorner{.position = static_cast<std::uint32_t>((i + a) * (rings + 1) + j + b)};
      };
      std::vector<MeshCorner> corners = {at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
      if (is_reversed) std::ranges::reverse(corners);
      add_face(mesh, corners, 0);
    }
  return mesh;
}

double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += dot(to_double(mesh.positions[a]),
               cross(to_double(mesh.positions[b]), to_double(mesh.positions[c])));
  return sum / 6.0;
}

TEST(ClosedMeshes, LathesAreTheirPolesMadeOne) {
  for (const int sectors : {6, 31}) {
    const double right = volume(prepared(lathe(sectors, false)).mesh);
    EXPECT_GT(right, 20.0);
    for (const bool is_reversed : {false, true}) {
      const PolygonMesh mesh = lathe(sectors, is_reversed);
      const MeshReport report = report_mesh(mesh);
      EXPECT_TRUE(report.is_closed);
      EXPECT_EQ(report.counts.open_edges, 0U);
      const PreparedMesh made = prepared(mesh);
      EXPECT_TRUE(made.mesh.is_closed);
      EXPECT_DOUBLE_EQ(volume(made.mesh), right);
      EXPECT_EQ(says(made.warnings, "1 closed surface inside out is turned"), is_reversed);
    }
  }
}

TEST(ClosedMeshes, OneThatIsOpenByLittleIsTurnedToo) {
  const PreparedMesh right = prepared(lathe(24, false, false));
  const PreparedMesh reversed = prepared(lathe(24, true, false));
  EXPECT_FALSE(right.mesh.is_closed);
  EXPECT_FALSE(reversed.mesh.is_closed);
  EXPECT_DOUBLE_EQ(volume(right.mesh), volume(reversed.mesh));
  EXPECT_GT(volume(right.mesh), 0.0);
  EXPECT_FALSE(says(right.warnings, "inside out"));
  EXPECT_TRUE(says(reversed.warnings, "1 surface inside out, open by little, is turned"));
}

TEST(ClosedMeshes, ABowlStaysAsItIs) {
  PolygonMesh bowl = make_sphere(1.0, 16);
  bowl.normals.clear();
  PolygonMesh half = bowl;
  half.corners.clear(), half.face_begin = {0}, half.part.clear();
  for (std::size_t f = 0; f < face_count(bowl); ++f) {
    std::vector<MeshCorner> corners(face(bowl, f).begin(), face(bowl, f).end());
    for (MeshCorner& corner : corners) corner.normal = corner.uv = no_index;
    std::ranges::reverse(corners);
    if (std::ranges::all_of(
            corners, [&](const MeshCorner& c) { return bowl.positions[c.position].y < 1e-3F; }))
      add_face(half, corners, 0);
  }
  half.uvs.clear();
  EXPECT_LT(volume(prepared(half).mesh), 0.0);
}

/// Faces of quadrilaterals, vertices counted from 0.
void add_quad(PolygonMesh& mesh, std::array<std::uint32_t, 4> corners) {
  std::vector<MeshCorner> face;
  for (const std::uint32_t i : corners) face.push_back({.position = i});
  add_face(mesh, face, 0);
}

/// Two boxes that share one edge, along z, where four faces meet.
PolygonMesh boxes_on_an_edge(bool second_is_reversed) {
  PolygonMesh mesh;
  mesh.name = "boxes";
  mesh.parts = {{}};
  const auto box = [&](float x, float y, bool is_reversed) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const float dz : {0.0F, 1.0F})
      for (const float dy : {0.0F, 1.0F})
        for (const float dx : {0.0F, 1.0F}) mesh.positions.push_back({x + dx, y + dy, dz});
    for (std::array<std::uint32_t, 4> q : {std::array<std::uint32_t, 4>{0, 2, 3, 1},
                                           {4, 5, 7, 6},
                                           {0, 1, 5, 4},
                                           {2, 6, 7, 3},
                                           {0, 4, 6, 2},
                                           {1, 3, 7, 5}}) {
      for (std::uint32_t& i : q) i += first;
      if (is_reversed) std::ranges::reverse(q);
      add_quad(mesh, q);
    }
  };
  box(0, 0, false);
  box(1, 1, second_is_reversed);
  return mesh;
}

TEST(ClosedMeshes, EdgesOfFourFacesAreClosedWhereTheyRunBothWaysAlike) {
  for (const bool is_reversed : {false, true}) {
    const MeshReport report = report_mesh(boxes_on_an_edge(is_reversed));
    EXPECT_EQ(report.counts.nonmanifold_edges, 1U);
    EXPECT_TRUE(report.is_closed);
    const PreparedMesh made = prepared(boxes_on_an_edge(is_reversed));
    EXPECT_TRUE(made.mesh.is_closed);
    EXPECT_DOUBLE_EQ(volume(made.mesh), 2.0);
  }
  // A fold of a scan: two faces back to back on an edge of the box.
  PolygonMesh folded = boxes_on_an_edge(false);
  folded.positions.push_back({0, 0, 2});
  const auto tip = static_cast<std::uint32_t>(folded.positions.size() - 1);
  const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const std::array<MeshCorner, 3> corners{{{.position = a}, {.position = b}, {.position = c}}};
    add_face(folded, corners, 0);
  };
  triangle(4, 5, tip);
  triangle(5, 4, tip);
  EXPECT_TRUE(report_mesh(folded).is_closed);
  EXPECT_TRUE(prepared(folded).mesh.is_closed);
  // A wall through the box has no inside on one side of it: three faces on an edge.
  PolygonMesh walled = boxes_on_an_edge(false);
  walled.positions.push_back({0, 0, 2});
  walled.positions.push_back({1, 0, 2});
  add_quad(walled, {4, 5, tip + 1, tip});
  EXPECT_FALSE(report_mesh(walled).is_closed);
  EXPECT_EQ(report_mesh(walled).counts.open_edges, 4U);
  EXPECT_FALSE(prepared(walled).mesh.is_closed);
}

std::string unpacked(const std::filesystem::path& file) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(
      popen(("gzip -dc '" + file.string() + "'").c_str(), "r"), pclose);
  std::string bytes;
  std::array<char, 65536> part{};
  for (std::size_t size = 1; size > 0;) {
    size = std::fread(part.data(), 1, part.size(), pipe.get());
    bytes.append(part.data(), size);
  }
  return bytes;
}

TEST(ClosedMeshes, TheStanfordDragonIsWhereverOneAsks) {
  const std::filesystem::path packed =
      std::filesystem::path(LAMINA_SHARED_DATA) / "meshes" / "dragon_vrip_res3.ply.gz";
  if (!std::filesystem::exists(packed)) GTEST_SKIP() << "no reference data at " << packed;
  const std::string bytes = unpacked(packed);
  const PolygonMesh dragon = parse_ply(bytes, "dragon.ply");
  const MeshReport report = report_mesh(dragon);
  EXPECT_EQ(report.counts.nonmanifold_edges, 2094U);
  EXPECT_TRUE(report.is_closed);
  EXPECT_TRUE(prepared(dragon).mesh.is_closed);
}

}  // namespace
}  // namespace lamina
