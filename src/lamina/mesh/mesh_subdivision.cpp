// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/mesh/mesh_subdivision.h"

#include <cassert>
#include <utility>

#include "lamina/core/error.h"
#include "lamina/mesh/mesh_edges.h"

namespace lamina {
namespace {

/// What is done where the surface, or an island of the texture, ends.
enum class Border {
  smooth,  ///< a cubic B-spline
  linear,  ///< left where it is
};

/// Positions or texture coordinates with the polygons that they form.
template <class T>
struct Channel {
  std::vector<T> values;
  std::vector<std::uint32_t> indices;  // [corner]
};

template <class T>
struct VertexSums {
  T faces{}, edges{}, border{};  // sums of face points, of edge midpoints, of border neighbours
  std::uint32_t face_count = 0, edge_count = 0, border_count = 0;
};

/// The sums over the faces and edges around each vertex that its new place is made of.
template <class T>
std::vector<VertexSums<T>> vertex_sums(const Channel<T>& channel, const MeshEdges& edges,
                                       std::span<const T> face_points,
                                       std::span<const std::uint32_t> face_begin) {
  std::vector<VertexSums<T>> sums(channel.values.size());
  for (std::size_t f = 0; f < face_points.size(); ++f)
    for (std::size_t c = face_begin[f]; c < face_begin[f + 1]; ++c) {
      VertexSums<T>& sum = sums[channel.indices[c]];
      sum.faces = sum.faces + face_points[f];
      ++sum.face_count;
    }
  for (const MeshEdge& edge : edges.edges)
    for (const int end : {0, 1}) {
      const std::size_t here = edge.vertex[static_cast<std::size_t>(end)];
      const std::size_t there = edge.vertex[static_cast<std::size_t>(1 - end)];
      VertexSums<T>& sum = sums[here];
      sum.edges = sum.edges + 0.5F * (channel.values[here] + channel.values[there]);
      ++sum.edge_count;
      if (edge.face_count == 2) continue;
      sum.border = sum.border + channel.values[there];
      ++sum.border_count;
    }
  return sums;
}

template <class T>
T moved_vertex(const T& old, const VertexSums<T>& sum, Border border) {
  if (sum.face_count == 0) return old;
  if (sum.border_count > 0) {
    const bool is_corner = sum.border_count != 2 || sum.face_count == 1;
    return border == Border::linear || is_corner ? old : 0.75F * old + 0.125F * sum.border;
  }
  const auto n = static_cast<float>(sum.edge_count);
  const T mean_of_faces = (1.0F / static_cast<float>(sum.face_count)) * sum.faces;
  const T mean_of_edges = (1.0F / n) * sum.edges;
  return (1.0F / n) * (mean_of_faces + 2.0F * mean_of_edges + (n - 3.0F) * old);
}

/// One step. New values: moved vertices, then edge points, then face points. Each corner becomes
/// the quadrilateral (vertex, edge point after it, face point, edge point before it).
template <class T>
Channel<T> subdivide(const Channel<T>& channel, std::span<const std::uint32_t> face_begin,
                     Border border) {
  const std::size_t faces = face_begin.size() - 1;
  const MeshEdges edges = make_mesh_edges(face_begin, channel.indices, channel.values.size());
  std::vector<T> face_points(faces);
  for (std::size_t f = 0; f < faces; ++f) {
    T sum{};
    for (std::size_t c = face_begin[f]; c < face_begin[f + 1]; ++c)
      sum = sum + channel.values[channel.indices[c]];
    face_points[f] = (1.0F / static_cast<float>(face_begin[f + 1] - face_begin[f])) * sum;
  }
  std::vector<std::uint32_t> face_of_corner(channel.indices.size());
  for (std::size_t f = 0; f < faces; ++f)
    for (std::size_t c = face_begin[f]; c < face_begin[f + 1]; ++c)
      face_of_corner[c] = static_cast<std::uint32_t>(f);

  Channel<T> result;
  result.values.reserve(channel.values.size() + edges.edges.size() + faces);
  const auto sums = vertex_sums<T>(channel, edges, face_points, face_begin);
  for (std::size_t v = 0; v < channel.values.size(); ++v)
    result.values.push_back(moved_vertex(channel.values[v], sums[v], border));
  for (const MeshEdge& edge : edges.edges) {
    const T middle = 0.5F * (channel.values[edge.vertex[0]] + channel.values[edge.vertex[1]]);
    result.values.push_back(edge.face_count == 2
                                ? 0.5F * middle +
                                      0.25F * (face_points[face_of_corner[edge.corner[0]]] +
                                               face_points[face_of_corner[edge.corner[1]]])
                                : middle);
  }
  result.values.insert(result.values.end(), face_points.begin(), face_points.end());

  const auto first_edge = static_cast<std::uint32_t>(channel.values.size());
  const auto first_face = static_cast<std::uint32_t>(first_edge + edges.edges.size());
  result.indices.reserve(4 * channel.indices.size());
  for (std::uint32_t f = 0; f < faces; ++f)
    for (std::uint32_t c = face_begin[f]; c < face_begin[f + 1]; ++c) {
      const std::uint32_t before = c > face_begin[f] ? c - 1 : face_begin[f + 1] - 1;
      result.indices.insert(result.indices.end(),
                            {channel.indices[c], first_edge + edges.edge_of_corner[c],
                             first_face + f, first_edge + edges.edge_of_corner[before]});
    }
  return result;
}

template <class T>
Channel<T> take_channel(PolygonMesh& mesh, std::vector<T>& values,
                        std::uint32_t MeshCorner::* index) {
  Channel<T> channel{.values = std::move(values), .indices = {}};
  if (!channel.values.empty())
    for (const MeshCorner& corner : mesh.corners) channel.indices.push_back(corner.*index);
  return channel;
}

}  // namespace

PolygonMesh subdivide_catmull_clark(PolygonMesh mesh, int levels) {
  assert(0 <= levels && levels <= most_subdivisions);
  if (levels == 0 || face_count(mesh) == 0) return mesh;
  constexpr std::size_t most_corners = 400'000'000;
  if (mesh.corners.size() << (2 * levels) > most_corners)
    throw InvalidInput(mesh.name + ": " + std::to_string(face_count(mesh)) + " faces, subdivided " +
                       std::to_string(levels) +
                       " times, must not give more than 100 million faces");
  Channel<Vec3f> positions = take_channel(mesh, mesh.positions, &MeshCorner::position);
  Channel<Vec2f> uvs = take_channel(mesh, mesh.uvs, &MeshCorner::uv);
  for (int level = 0; level < levels; ++level) {
    positions = subdivide(positions, mesh.face_begin, Border::smooth);
    if (!uvs.values.empty()) uvs = subdivide(uvs, mesh.face_begin, Border::linear);
    std::vector<std::uint32_t> part;
    part.reserve(positions.indices.size() / 4);
    for (std::size_t f = 0; f < face_count(mesh); ++f)
      part.insert(part.end(), mesh.face_begin[f + 1] - mesh.face_begin[f], mesh.part[f]);
    mesh.part = std::move(part);
    mesh.face_begin.resize(mesh.part.size() + 1);
    for (std::size_t f = 0; f < mesh.face_begin.size(); ++f)
      mesh.face_begin[f] = static_cast<std::uint32_t>(4 * f);
  }
  mesh.corners.assign(positions.indices.size(), {});
  for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
    mesh.corners[c].position = positions.indices[c];
    if (!uvs.values.empty()) mesh.corners[c].uv = uvs.indices[c];
  }
  mesh.positions = std::move(positions.values);
  mesh.uvs = std::move(uvs.values);
  mesh.normals.clear();
  return mesh;
}

}  // namespace lamina
