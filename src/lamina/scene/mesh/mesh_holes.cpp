// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/mesh_holes.h"

#include <array>
#include <cassert>
#include <cstdint>
#include <map>

#include "lamina/scene/mesh/mesh_edges.h"

namespace lamina {
namespace {

/// An edge of one face only, as the face runs along it.
struct BorderEdge {
  MeshCorner from;
  std::uint32_t to, part;
};

/// Border edges by the vertex that they start from.
using BorderEdges = std::multimap<std::uint32_t, BorderEdge>;

BorderEdges find_border(const PolygonMesh& mesh, const std::vector<bool>& closes) {
  std::vector<std::uint32_t> vertices;
  for (const MeshCorner& corner : mesh.corners) vertices.push_back(corner.position);
  const MeshEdges edges = make_mesh_edges(mesh.face_begin, vertices, mesh.positions.size());
  BorderEdges border;
  for (std::size_t f = 0; f < face_count(mesh); ++f) {
    if (!closes[mesh.part[f]]) continue;
    const std::uint32_t begin = mesh.face_begin[f], end = mesh.face_begin[f + 1];
    for (std::uint32_t c = begin; c < end; ++c)
      if (edges.edges[edges.edge_of_corner[c]].face_count == 1)
        border.insert(
            {vertices[c], {mesh.corners[c], vertices[c + 1 < end ? c + 1 : begin], mesh.part[f]}});
  }
  return border;
}

/// The edges from one on until they come back to where it starts; empty if they do not.
std::vector<BorderEdge> take_loop(BorderEdges& border) {
  std::vector<BorderEdge> loop;
  const std::uint32_t start = border.begin()->first;
  for (auto at = border.begin(); at != border.end(); at = border.find(loop.back().to)) {
    loop.push_back(at->second);
    border.erase(at);
    if (loop.back().to == start) return loop;
  }
  return {};
}

}  // namespace

std::size_t close_holes(PolygonMesh& mesh, const std::vector<bool>& closes) {
  assert(closes.size() == mesh.parts.size());
  BorderEdges border = find_border(mesh, closes);
  std::size_t closed = 0;
  while (!border.empty()) {
    const std::vector<BorderEdge> loop = take_loop(border);
    if (loop.size() < 3) continue;
    Vec3 sum;
    for (const BorderEdge& edge : loop) {
      const Vec3f& p = mesh.positions[edge.from.position];
      sum += Vec3{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
    }
    const Vec3 mean = sum / static_cast<double>(loop.size());
    const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(
        {static_cast<float>(mean.x), static_cast<float>(mean.y), static_cast<float>(mean.z)});
    const auto corner = [&](std::uint32_t position) {
      return MeshCorner{.position = position,
                        .normal = no_index,
                        .uv = loop.front().from.uv,
                        .color = loop.front().from.color};
    };
    for (const BorderEdge& edge : loop)
      add_face(mesh, std::array{corner(edge.to), corner(edge.from.position), corner(middle)},
               edge.part);
    ++closed;
  }
  return closed;
}

}  // namespace lamina
