// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/depth_layers/triangle_neighbors.h"

#include <algorithm>
#include <cstddef>
#include <tuple>

namespace lamina {

TriangleNeighbors find_triangle_neighbors(std::span<const std::array<std::uint32_t, 3>> triangles) {
  struct Edge {
    std::uint32_t low, high, triangle, edge;
    [[nodiscard]] bool joins(const Edge& other) const {
      return low == other.low && high == other.high;
    }
  };
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t e = 0; e < 3; ++e) {
      const auto [low, high] = std::minmax(triangles[t][e], triangles[t][(e + 1) % 3]);
      edges.push_back({low, high, t, e});
    }
  std::ranges::sort(edges, {}, [](const Edge& edge) {
    return std::tuple(edge.low, edge.high, edge.triangle, edge.edge);
  });
  TriangleNeighbors neighbors(triangles.size(), {no_neighbor, no_neighbor, no_neighbor});
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const Edge &a = edges[i - 1], &b = edges[i];
    if (!a.joins(b) || a.triangle == b.triangle) continue;
    neighbors[a.triangle][a.edge] = b.triangle;
    neighbors[b.triangle][b.edge] = a.triangle;
  }
  return neighbors;
}

}  // namespace lamina
