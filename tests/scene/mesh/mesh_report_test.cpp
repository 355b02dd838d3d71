// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/mesh_report.h"

#include <gtest/gtest.h>

#include "lamina/scene/mesh/files/mesh_file.h"
#include "lamina/scene/mesh/mesh_shapes.h"

namespace lamina {
namespace {

TEST(MeshReport, CountsWhatABoxIs) {
  const MeshReport report = report_mesh(make_box({1, 2, 3}, 2));
  EXPECT_EQ(report.counts.faces, 24U);
  EXPECT_EQ(report.counts.triangles, 48U);
  EXPECT_EQ(report.vertices, 26U);
  EXPECT_EQ(report.surfaces, 1U);
  EXPECT_EQ(report.counts.open_edges, 0U);
  EXPECT_EQ(report.counts.nonmanifold_edges, 0U);
  EXPECT_EQ(report.uv_islands, 6U);  // each side the whole texture
  EXPECT_EQ(report.counts.high - report.counts.low, (Vec3f{1, 2, 3}));
  EXPECT_EQ(report.tiles, std::vector<int>{1001});
}

// Three squares on one edge, one of them twice as long as wide, one of them folded to nothing.
TEST(MeshReport, CountsOpenAndNonmanifoldEdgesAndFacesWithoutArea) {
  const MeshReport report = report_mesh(parse_obj(R"(
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 1 0 1
v 0 0 1
v 1 -2 0
v 0 -2 0
vt 0.5 0.5
vt 1.5 0.5
vt 3.5 12.5
g up
f 1/1 2/1 3/1 4/1
g front
f 1 2 5 6
g down
f 2/2 1/2 8/2 7/2
f 1/3 2/3 1/3
)",
                                                  "t.obj"));
  EXPECT_EQ(report.counts.faces, 4U);
  EXPECT_EQ(report.counts.degenerate_faces, 1U);
  EXPECT_EQ(report.counts.nonmanifold_edges, 1U);  // from 1 to 2
  EXPECT_EQ(report.counts.open_edges, 10U);        // that one, too: two run one way, one the other
  ASSERT_EQ(report.parts.size(), 3U);
  EXPECT_EQ(report.parts[0].labels, std::vector<std::string>{"up"});
  EXPECT_EQ(report.parts[1].counts.open_edges, 3U);
  EXPECT_EQ(report.parts[2].counts.high.z, 0.0F);
  EXPECT_EQ(report.faces_without_uv, 1U);
  EXPECT_EQ(report.uv_islands, 3U);
  EXPECT_EQ(report.tiles, (std::vector<int>{1001, 1002, 1124}));
}

}  // namespace
}  // namespace lamina
