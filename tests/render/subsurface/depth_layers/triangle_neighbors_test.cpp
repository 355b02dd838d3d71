// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/depth_layers/triangle_neighbors.h"

#include <gtest/gtest.h>

#include <cstddef>

#include "render/small_scenes.h"

namespace lamina {
namespace {

TEST(TriangleNeighbors, AreAcrossTheEdgesOfThree) {
  //  3 - 2
  //  | / | \.
  //  0 - 1 - 4, and a triangle apart
  const std::vector<std::array<std::uint32_t, 3>> triangles = {
      {0, 1, 2}, {0, 2, 3}, {4, 2, 1}, {5, 6, 7}};
  const TriangleNeighbors neighbors = find_triangle_neighbors(triangles);
  const std::uint32_t none = no_neighbor;
  EXPECT_EQ(neighbors[0], (std::array{none, 2u, 1u}));
  EXPECT_EQ(neighbors[1], (std::array{0u, none, none}));
  EXPECT_EQ(neighbors[2], (std::array{none, 0u, none}));
  EXPECT_EQ(neighbors[3], (std::array{none, none, none}));
}

TEST(TriangleNeighbors, OfAClosedMeshAreMutual) {
  const Mesh ball = make_sphere(1.0f, 16);
  const TriangleNeighbors neighbors = find_triangle_neighbors(ball.triangles);
  std::size_t found = 0;
  for (std::uint32_t t = 0; t < neighbors.size(); ++t)
    for (const std::uint32_t other : neighbors[t]) {
      if (other == no_neighbor) continue;
      ++found;
      EXPECT_EQ(std::ranges::count(neighbors[other], t), 1) << t;
    }
  EXPECT_GT(found, 2 * neighbors.size());  // but along the seam of texture coordinates
}

}  // namespace
}  // namespace lamina
