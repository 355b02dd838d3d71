// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/mesh_edges.h"

#include <algorithm>
#include <utility>

namespace lamina {

MeshEdges make_mesh_edges(std::span<const std::uint32_t> face_begin,
                          std::span<const std::uint32_t> vertices, std::size_t vertex_count) {
  // Sort the half-edges by their lower vertex (counting), then each such group by the higher one.
  struct Half {
    std::uint32_t high, corner;
  };
  std::vector<std::uint32_t> next(vertices.size());  // [corner], the next corner of its face
  for (std::size_t f = 0; f + 1 < face_begin.size(); ++f)
    for (std::uint32_t c = face_begin[f]; c < face_begin[f + 1]; ++c)
      next[c] = c + 1 < face_begin[f + 1] ? c + 1 : face_begin[f];
  std::vector<std::uint32_t> group(vertex_count + 1);  // [vertex], its first half-edge
  const auto low = [&](std::uint32_t c) { return std::min(vertices[c], vertices[next[c]]); };
  for (std::uint32_t c = 0; c < vertices.size(); ++c) ++group[low(c) + 1];
  for (std::size_t v = 0; v < vertex_count; ++v) group[v + 1] += group[v];
  std::vector<Half> halves(vertices.size());
  std::vector<std::uint32_t> filled(group.begin(), group.end() - 1);
  for (std::uint32_t c = 0; c < vertices.size(); ++c)
    halves[filled[low(c)]++] = {std::max(vertices[c], vertices[next[c]]), c};

  MeshEdges result;
  result.edge_of_corner.resize(vertices.size());
  for (std::uint32_t v = 0; v < vertex_count; ++v) {
    const std::span mine = std::span(halves).subspan(group[v], group[v + 1] - group[v]);
    std::ranges::sort(mine, [](const Half& a, const Half& b) {
      return std::pair(a.high, a.corner) < std::pair(b.high, b.corner);
    });
    for (std::size_t i = 0; i < mine.size(); ++i) {
      if (i == 0 || mine[i].high != mine[i - 1].high)
        result.edges.push_back({.vertex = {v, mine[i].high}});
      MeshEdge& edge = result.edges.back();
      if (edge.face_count < 2) edge.corner[edge.face_count] = mine[i].corner;
      ++edge.face_count;
      result.edge_of_corner[mine[i].corner] = static_cast<std::uint32_t>(result.edges.size() - 1);
    }
  }
  return result;
}

}  // namespace lamina
