// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/mesh_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/mesh_edges.h"
#include "lamina/scene/mesh/mesh_orientation.h"

namespace lamina {
namespace {

/// Faces that belong together.
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[root(a)] = root(b); }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

std::vector<std::uint32_t> faces_of_corners(const PolygonMesh& mesh) {
  std::vector<std::uint32_t> result(mesh.corners.size());
  for (std::uint32_t f = 0; f < face_count(mesh); ++f)
    for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c) result[c] = f;
  return result;
}

/// How many groups of faces there are that edges of two faces and more connect.
/// @param vertices  [corner], what they have in common there; no_index: nothing
std::size_t connected_groups(const PolygonMesh& mesh, std::vector<std::uint32_t> vertices,
                             std::size_t vertex_count) {
  const std::vector<std::uint32_t> face_of = faces_of_corners(mesh);
  Groups groups(face_count(mesh));
  std::vector<bool> counts(face_count(mesh), true);
  for (std::size_t c = 0; c < vertices.size(); ++c)
    if (vertices[c] == no_index) counts[face_of[c]] = false, vertices[c] = 0;
  const MeshEdges edges = make_mesh_edges(mesh.face_begin, vertices, vertex_count);
  std::vector<std::uint32_t> first(edges.edges.size(), no_index);  // [edge], a face
  for (std::size_t c = 0; c < vertices.size(); ++c) {
    if (!counts[face_of[c]]) continue;
    std::uint32_t& face = first[edges.edge_of_corner[c]];
    if (face == no_index)
      face = face_of[c];
    else
      groups.join(face_of[c], face);
  }
  std::set<std::uint32_t> roots;
  for (std::uint32_t f = 0; f < face_count(mesh); ++f)
    if (counts[f]) roots.insert(groups.root(f));
  return roots.size();
}

bool is_degenerate(const PolygonMesh& mesh, std::size_t f) {
  const auto corners = face(mesh, f);
  double longest = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    longest = std::max(
        longest, length(to_double(mesh.positions[corners[i].position]) -
                        to_double(mesh.positions[corners[(i + 1) % corners.size()].position])));
  return !(length(doubled_area(mesh, f)) > 1e-7 * longest * longest);
}

std::vector<int> tiles_of(const PolygonMesh& mesh) {
  constexpr std::size_t most = 1000;
  std::set<int> tiles;
  for (std::size_t f = 0; f < face_count(mesh) && tiles.size() < most; ++f) {
    Vec2f middle{};
    bool is_whole = true;
    for (const MeshCorner& corner : face(mesh, f)) {
      is_whole = is_whole && corner.uv != no_index;
      if (is_whole)
        middle = middle + (1.0F / static_cast<float>(face(mesh, f).size())) * mesh.uvs[corner.uv];
    }
    if (is_whole && middle.x >= 0.0F && middle.x < 10.0F && middle.y >= 0.0F && middle.y < 100.0F)
      tiles.insert(1001 + static_cast<int>(middle.x) + 10 * static_cast<int>(middle.y));
  }
  return {tiles.begin(), tiles.end()};
}

void count_edges(PolygonMesh mesh, MeshReport& report) {
  (void)drop_collapsed_faces(mesh);  // as those at the poles of spheres
  std::vector<std::uint32_t> positions, face_of = faces_of_corners(mesh);
  for (const MeshCorner& corner : mesh.corners) positions.push_back(corner.position);
  const MeshEdges edges = make_mesh_edges(mesh.face_begin, positions, mesh.positions.size());
  std::vector<bool> is_counted(edges.edges.size());
  for (std::size_t c = 0; c < positions.size(); ++c) {
    const std::uint32_t e = edges.edge_of_corner[c];
    if (is_counted[e] || edges.edges[e].face_count <= 2) continue;
    is_counted[e] = true;
    for (FaceCounts* counts : {&report.counts, &report.parts[mesh.part[face_of[c]]].counts})
      ++counts->nonmanifold_edges;
  }
  const OrientedMesh oriented = orient_mesh(std::move(mesh));
  report.is_closed = oriented.is_closed;
  for (const OpenEdges& open : oriented.open) {
    report.counts.open_edges += open.count;
    report.parts[open.part].counts.open_edges += open.count;
  }
}

}  // namespace

MeshReport report_mesh(PolygonMesh mesh) {
  MeshReport report;
  report.uv_sets = mesh.uv_sets;
  report.has_colors = !mesh.colors.empty();
  (void)unify_indices(mesh);
  report.creases = mesh.creases.size();
  report.vertices = mesh.positions.size();
  for (const MeshPart& part : mesh.parts)
    report.parts.push_back({.labels = part.labels, .counts = {}});

  std::vector<std::uint32_t> positions, uvs;
  for (const MeshCorner& corner : mesh.corners) {
    positions.push_back(corner.position);
    uvs.push_back(corner.uv);
  }
  for (std::size_t f = 0; f < face_count(mesh); ++f) {
    const auto corners = face(mesh, f);
    const bool has_no_area = is_degenerate(mesh, f);
    for (FaceCounts* counts : {&report.counts, &report.parts[mesh.part[f]].counts}) {
      const bool is_first = counts->faces == 0;
      for (const MeshCorner& corner : corners)
        for (int a = 0; a < 3; ++a) {
          const float x = mesh.positions[corner.position][a];
          const bool is_new = is_first && &corner == corners.data();
          counts->low[a] = is_new ? x : std::min(counts->low[a], x);
          counts->high[a] = is_new ? x : std::max(counts->high[a], x);
        }
      ++counts->faces;
      counts->triangles += corners.size() - 2;
      if (has_no_area) ++counts->degenerate_faces;
    }
    if (std::ranges::any_of(corners, [](const MeshCorner& c) { return c.uv == no_index; }))
      ++report.faces_without_uv;
  }
  count_edges(mesh, report);
  report.surfaces = connected_groups(mesh, std::move(positions), mesh.positions.size());
  if (!mesh.uvs.empty()) {
    report.uv_islands = connected_groups(mesh, std::move(uvs), mesh.uvs.size());
    report.tiles = tiles_of(mesh);
  }
  return report;
}

PolygonMesh polygons_of(const Mesh& mesh) {
  PolygonMesh result;
  result.name = mesh.name;
  result.positions = mesh.positions;
  result.uvs = mesh.uvs;
  result.colors = mesh.colors;
  result.uv_sets = mesh.uvs.empty() ? 0 : 1;
  std::map<std::uint32_t, std::uint32_t> part_of;  // by material
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [part, is_new] =
        part_of.try_emplace(mesh.material[t], static_cast<std::uint32_t>(result.parts.size()));
    if (is_new) result.parts.push_back({.labels = {}, .material = mesh.material[t]});
    std::array<MeshCorner, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t vertex = mesh.triangles[t][c];
      corners[c] = {.position = vertex,
                    .uv = mesh.uvs.empty() ? no_index : vertex,
                    .color = mesh.colors.empty() ? no_index : vertex};
    }
    add_face(result, corners, part->second);
  }
  return result;
}

std::size_t rendering_memory(std::size_t vertices, std::size_t triangles) {
  constexpr std::size_t per_vertex = 3 * sizeof(Vec3f) + sizeof(Vec2f);
  constexpr std::size_t per_triangle = 4 * sizeof(std::uint32_t) + 100;
  return vertices * per_vertex + triangles * per_triangle;
}

}  // namespace lamina
