// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/internal/mesh_borders.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "lamina/scene/mesh/files/mesh_file.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/mesh/mesh_orientation.h"
#include "lamina/scene/mesh/mesh_shapes.h"
#include "scene/mesh/mesh_samples.h"

namespace lamina {
namespace {

/// A box as six sheets, each with vertices of its own moved by up to `error` in every coordinate.
PolygonMesh box_of_sheets(float error) {
  const PolygonMesh box = make_box({1, 2, 3}, 1);
  PolygonMesh sheets;
  sheets.name = "box";
  sheets.parts = {{}};
  int count = 0;
  for (std::size_t f = 0; f < face_count(box); ++f) {
    std::vector<MeshCorner> corners;
    for (const MeshCorner& corner : face(box, f)) {
      Vec3f p = box.positions[corner.position];
      p.x += error * static_cast<float>(count % 3 - 1);
      p.y -= error * static_cast<float>(count++ % 2);
      corners.push_back({.position = static_cast<std::uint32_t>(sheets.positions.size()),
                         .uv = static_cast<std::uint32_t>(sheets.uvs.size())});
      sheets.positions.push_back(p);
      sheets.uvs.push_back({static_cast<float>(f), static_cast<float>(corners.size())});
    }
    add_face(sheets, corners, 0);
  }
  return sheets;
}

TEST(MeshBorders, ThatDifferByRoundingAreOneAndTheirTextureStays) {
  const PreparedMesh box = prepared(box_of_sheets(3e-7F));
  EXPECT_TRUE(box.mesh.is_closed);
  ASSERT_EQ(box.warnings.size(), 1U);
  EXPECT_NE(box.warnings[0].find("vertices along open edges joined"), std::string::npos);
  // Each of the 24 corners keeps its texture coordinates.
  std::vector<std::pair<float, float>> uvs;
  for (const Vec2f& uv : box.mesh.uvs) uvs.emplace_back(uv.x, uv.y);
  std::ranges::sort(uvs);
  uvs.erase(std::ranges::unique(uvs).begin(), uvs.end());
  EXPECT_EQ(uvs.size(), 24U);
}

TEST(MeshBorders, ThatDifferByMoreStayOpen) {
  EXPECT_FALSE(prepared(box_of_sheets(1e-4F)).mesh.is_closed);
}

// The sine of a whole turn, in floating point, is not 0.
TEST(MeshBorders, OfASeamThatWasComputedTwiceAreClosedAndTurnedOutward) {
  std::string obj;
  const auto add = [&](double angle) {
    for (const double z : {0.0, 1.0})
      obj += "v " + std::to_string(std::cos(angle)) + " " +
             (std::abs(std::sin(angle)) < 1e-9 && angle > 1.0 ? "-4.9e-16"
                                                              : std::to_string(std::sin(angle))) +
             " " + std::to_string(z) + "\n";
  };
  constexpr int sides = 8;
  for (int i = 0; i <= sides; ++i) add(2.0 * 3.14159265358979 * i / sides);
  const auto bottom = [](int i) { return std::to_string(2 * i + 1); };
  const auto top = [](int i) { return std::to_string(2 * i + 2); };
  std::string low = "f", high = "f";
  for (int i = 0; i < sides; ++i) {  // inside out
    obj += "f " + bottom(i) + " " + top(i) + " " + top(i + 1) + " " + bottom(i + 1) + "\n";
    low += " " + bottom(i);
    high += " " + top(sides - i);
  }
  const PreparedMesh mesh = prepared(parse_obj(obj + low + "\n" + high + "\n", "tube.obj"));
  EXPECT_TRUE(mesh.mesh.is_closed);
  EXPECT_TRUE(std::ranges::any_of(mesh.warnings, [](const std::string& warning) {
    return warning.find("1 closed surface inside out is turned") != std::string::npos;
  }));
}

TEST(MeshBorders, LeaveTheTwoSidesOfAThinSheetApart) {
  PolygonMesh sheet = make_box({1, 1, 1e-7}, 4);  // thinner than what joins borders
  unify_indices(sheet);
  const std::size_t vertices = sheet.positions.size();
  EXPECT_EQ(join_borders(sheet), 0U);
  EXPECT_EQ(prepared(make_box({1, 1, 1e-7}, 4)).mesh.is_closed, true);
  EXPECT_EQ(vertices, 98U);  // 6 · 4² + 2
}

TEST(MeshBorders, KeepTheEndsOfShortEdgesApart) {
  // A strip whose steps are shorter than what joins borders, beside a long triangle.
  PolygonMesh mesh = parse_obj(
      "v 0 0 0\nv 4e-7 0 0\nv 8e-7 0 0\nv 0 1 0\nv 4e-7 1 0\nv 8e-7 1 0\n"
      "f 1 2 5 4\nf 2 3 6 5\n",
      "strip.obj");
  unify_indices(mesh);
  for (std::size_t f = 0; f < 2; ++f)
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_NE(face(mesh, f)[i].position, face(mesh, f)[(i + 1) % 4].position);
}

TEST(MeshBorders, AreNamedByTheirPartWithCountAndPlace) {
  // A closed box as "body", an open square 5 away as "scarf".
  PolygonMesh mesh = make_box({1, 1, 1}, 1);
  mesh.parts = {{{"skin", "body"}}, {{"cloth", "scarf"}}};
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const float y : {0.0F, 2.0F})
    for (const float x : {5.0F, 7.0F}) mesh.positions.push_back({x, y, 0});
  std::vector<MeshCorner> corners;
  for (const std::uint32_t i : {0U, 1U, 3U, 2U})
    corners.push_back({.position = first + i, .normal = 0, .uv = 0});
  add_face(mesh, corners, 1);
  const std::vector<std::uint32_t> materials = {3, 8};
  const Mesh made = make_mesh(std::move(mesh), {}, materials).mesh;
  EXPECT_FALSE(made.is_closed);
  ASSERT_EQ(made.open_parts.size(), 1U);
  EXPECT_EQ(made.open_parts[0].name, "cloth, scarf");
  EXPECT_EQ(made.open_parts[0].edges, 4U);
  EXPECT_EQ(made.open_parts[0].place, (Vec3f{6, 0, 0}));
  EXPECT_TRUE(is_closed(made, 3));
  EXPECT_FALSE(is_closed(made, 8));
}

}  // namespace
}  // namespace lamina
