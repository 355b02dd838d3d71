// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/mesh_holes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>

#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/mesh/mesh_shapes.h"

namespace lamina {
namespace {

/// A box of 1 by 2 by 3 without some of its faces.
PolygonMesh open_box(std::initializer_list<std::size_t> left_out) {
  const PolygonMesh box = make_box({1, 2, 3}, 1);
  PolygonMesh open = box;
  open.corners.clear();
  open.face_begin = {0};
  open.part.clear();
  for (std::size_t f = 0; f < face_count(box); ++f)
    if (std::ranges::find(left_out, f) == left_out.end()) add_face(open, face(box, f), box.part[f]);
  return open;
}

double volume_of(const Mesh& mesh) {
  double volume = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    volume +=
        static_cast<double>(dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c]))) /
        6.0;
  return volume;
}

TEST(CloseHoles, GivesABoxBackItsFaces) {
  for (const auto& left_out : {std::initializer_list<std::size_t>{0}, {1, 4}, {0, 3, 5}}) {
    const PolygonMesh open = open_box(left_out);
    const std::vector<std::uint32_t> materials(open.parts.size());
    EXPECT_FALSE(make_mesh(open, {.to_world = {}}, materials).mesh.is_closed);
    MeshOptions options;
    options.closes.assign(open.parts.size(), true);
    const PreparedMesh closed = make_mesh(open, options, materials);
    EXPECT_TRUE(closed.mesh.is_closed);
    EXPECT_TRUE(closed.warnings.empty()) << closed.warnings.front();
    if (left_out.size() == 1) {
      EXPECT_NEAR(volume_of(closed.mesh), 6.0, 1e-5);
    }
  }
}

TEST(CloseHoles, LeavesPartsThatAreNotNamedAndClosedMeshes) {
  PolygonMesh open = open_box({2});
  EXPECT_EQ(close_holes(open, std::vector<bool>(open.parts.size(), false)), 0u);
  PolygonMesh box = make_box({1, 2, 3}, 1);
  (void)unify_indices(box);
  EXPECT_EQ(close_holes(box, std::vector<bool>(box.parts.size(), true)), 0u);
}

}  // namespace
}  // namespace lamina
