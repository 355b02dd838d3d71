// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/internal/mesh_borders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/mesh_edges.h"

namespace lamina {
namespace {

constexpr double tolerance = 1e-6;  // of the mesh's longest side

double longest_side(const PolygonMesh& mesh) {
  double longest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] =
        std::ranges::minmax_element(mesh.positions, {}, [axis](const Vec3f& p) { return p[axis]; });
    if (low != mesh.positions.end())
      longest =
          std::max(longest, static_cast<double>((*high)[axis]) - static_cast<double>((*low)[axis]));
  }
  return longest;
}

/// The ends of open edges, and the vertices that edges join to them and must not become one.
struct Borders {
  std::vector<std::uint32_t> vertices;        // in rising order
  std::vector<std::uint32_t> first_neighbor;  // [vertex of the mesh], one more ends the last
  std::vector<std::uint32_t> neighbors;
};

/// [edge], whether it is open, shorter than what joins vertices, and the only one of its face that
/// is: such as at the pole of a lathe, whose faces have two corners there.
std::vector<bool> shrinking_edges(const PolygonMesh& mesh, const MeshEdges& edges, double reach) {
  std::vector<bool> shrinks(edges.edges.size());
  const auto is_short = [&](std::uint32_t corner) {
    const auto& [a, b] = edges.edges[edges.edge_of_corner[corner]].vertex;
    return length(to_double(mesh.positions[a]) - to_double(mesh.positions[b])) <= reach;
  };
  for (std::size_t f = 0; f < face_count(mesh); ++f) {
    std::uint32_t found = no_index;
    int count = 0;
    for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c)
      if (is_short(c)) found = edges.edge_of_corner[c], ++count;
    if (count == 1 && edges.edges[found].face_count == 1) shrinks[found] = true;
  }
  return shrinks;
}

Borders find_borders(const PolygonMesh& mesh, double reach) {
  std::vector<std::uint32_t> corners;
  corners.reserve(mesh.corners.size());
  for (const MeshCorner& corner : mesh.corners) corners.push_back(corner.position);
  const MeshEdges edges = make_mesh_edges(mesh.face_begin, corners, mesh.positions.size());
  Borders borders;
  std::vector<bool> is_on_border(mesh.positions.size());
  for (const MeshEdge& edge : edges.edges)
    if (edge.face_count == 1)
      for (const std::uint32_t vertex : edge.vertex) is_on_border[vertex] = true;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    if (is_on_border[v]) borders.vertices.push_back(v);
  if (borders.vertices.empty()) return borders;
  borders.first_neighbor.resize(mesh.positions.size() + 1);
  const std::vector<bool> shrinks = shrinking_edges(mesh, edges, reach);
  const auto for_each_pair = [&](const auto& act) {
    for (std::size_t e = 0; e < edges.edges.size(); ++e)
      for (const std::size_t end : {0, 1}) {
        const auto& vertex = edges.edges[e].vertex;
        if (is_on_border[vertex[end]] && !shrinks[e]) act(vertex[end], vertex[1 - end]);
      }
  };
  for_each_pair([&](std::uint32_t v, std::uint32_t) { ++borders.first_neighbor[v + 1]; });
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    borders.first_neighbor[v + 1] += borders.first_neighbor[v];
  borders.neighbors.resize(borders.first_neighbor.back());
  std::vector<std::uint32_t> next(borders.first_neighbor.begin(), borders.first_neighbor.end() - 1);
  for_each_pair(
      [&](std::uint32_t v, std::uint32_t other) { borders.neighbors[next[v]++] = other; });
  return borders;
}

/// Vertices to which others may be joined, by the cells of a grid that they lie in.
class Grid {
 public:
  Grid(const PolygonMesh& mesh, double reach) : mesh_(mesh), reach_(reach) {}

  void add(std::uint32_t vertex) { cells_[cell_of(place(vertex))].push_back(vertex); }

  /// The nearest vertex within reach for which `may_join` holds, else no_index.
  template <class MayJoin>
  [[nodiscard]] std::uint32_t nearest(std::uint32_t vertex, const MayJoin& may_join) const {
    const Vec3 p = place(vertex);
    const Cell low = cell_of(p - Vec3{reach_, reach_, reach_});
    const Cell high = cell_of(p + Vec3{reach_, reach_, reach_});
    std::uint32_t best = no_index;
    double least = reach_;
    for (std::int64_t x = low[0]; x <= high[0]; ++x)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const auto found = cells_.find({x, y, z});
          if (found == cells_.end()) continue;
          for (const std::uint32_t candidate : found->second) {
            const double distance = length(place(candidate) - p);
            const bool is_better = best == no_index ? distance <= least : distance < least;
            if (is_better && may_join(candidate)) best = candidate, least = distance;
          }
        }
    return best;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& cell) const {
      std::uint64_t hash = 0;
      for (const std::int64_t i : cell)
        hash = (hash ^ static_cast<std::uint64_t>(i)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
      return hash;
    }
  };

  [[nodiscard]] Vec3 place(std::uint32_t v) const { return to_double(mesh_.positions[v]); }
  [[nodiscard]] Cell cell_of(const Vec3& p) const {
    const double side = 4.0 * reach_;  // so that most vertices look into one cell only
    return {static_cast<std::int64_t>(std::floor(p.x / side)),
            static_cast<std::int64_t>(std::floor(p.y / side)),
            static_cast<std::int64_t>(std::floor(p.z / side))};
  }

  const PolygonMesh& mesh_;
  double reach_;
  std::unordered_map<Cell, std::vector<std::uint32_t>, Hash> cells_;
};

}  // namespace

std::size_t join_borders(PolygonMesh& mesh) {
  const double reach = tolerance * longest_side(mesh);
  const Borders borders = find_borders(mesh, reach);
  if (borders.vertices.empty() || !(reach > 0.0)) return 0;
  std::vector<std::uint32_t> joined(mesh.positions.size());  // [vertex], what it becomes
  for (std::uint32_t v = 0; v < joined.size(); ++v) joined[v] = v;
  Grid grid(mesh, reach);
  std::size_t count = 0;
  for (const std::uint32_t v : borders.vertices) {
    const auto neighbors = std::span(borders.neighbors)
                               .subspan(borders.first_neighbor[v],
                                        borders.first_neighbor[v + 1] - borders.first_neighbor[v]);
    const std::uint32_t found = grid.nearest(v, [&](std::uint32_t candidate) {
      return std::ranges::none_of(neighbors,
                                  [&](std::uint32_t other) { return joined[other] == candidate; });
    });
    if (found == no_index) {
      grid.add(v);
    } else {
      joined[v] = found;
      ++count;
    }
  }
  if (count > 0) {
    for (MeshCorner& corner : mesh.corners) corner.position = joined[corner.position];
    for (MeshCrease& crease : mesh.creases)
      crease.a = joined[crease.a], crease.b = joined[crease.b];
  }
  return count;
}

}  // namespace lamina
