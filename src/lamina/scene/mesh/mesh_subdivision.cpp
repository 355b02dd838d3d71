// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/mesh/mesh_subdivision.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/scene/mesh/mesh_edges.h"

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
  T creased{};                   // sum of the neighbours along creases
  float sharpness = 0.0F;        // sum over those
  std::uint32_t face_count = 0, edge_count = 0, border_count = 0, crease_count = 0;
};

/// [corner], the sharpness of the edge to the next corner of its face; empty if no edge is sharp.
using CornerSharpness = std::vector<float>;

float sharpness_of(const MeshEdge& edge, std::span<const float> sharpness) {
  return sharpness.empty() || edge.face_count != 2 ? 0.0F : sharpness[edge.corner[0]];
}

/// The sums over the faces and edges around each vertex that its new place is made of.
template <class T>
std::vector<VertexSums<T>> vertex_sums(const Channel<T>& channel, const MeshEdges& edges,
                                       std::span<const T> face_points,
                                       std::span<const std::uint32_t> face_begin,
                                       std::span<const float> sharpness) {
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
      if (const float sharp = sharpness_of(edge, sharpness); sharp > 0.0F) {
        sum.creased = sum.creased + channel.values[there];
        sum.sharpness += sharp;
        ++sum.crease_count;
      }
      if (edge.face_count == 2) continue;
      sum.border = sum.border + channel.values[there];
      ++sum.border_count;
    }
  return sums;
}

/// A mean of the smooth and the sharp place, as sharp as it says.
template <class T>
T blend(const T& smooth, const T& sharp, float sharpness) {
  return sharpness >= 1.0F ? sharp : (1.0F - sharpness) * smooth + sharpness * sharp;
}

template <class T>
T smoothly_moved_vertex(const T& old, const VertexSums<T>& sum) {
  const auto n = static_cast<float>(sum.edge_count);
  const T mean_of_faces = (1.0F / static_cast<float>(sum.face_count)) * sum.faces;
  const T mean_of_edges = (1.0F / n) * sum.edges;
  return (1.0F / n) * (mean_of_faces + 2.0F * mean_of_edges + (n - 3.0F) * old);
}

template <class T>
T moved_vertex(const T& old, const VertexSums<T>& sum, Border border) {
  if (sum.face_count == 0) return old;
  const float sharpness =
      sum.crease_count > 0 ? sum.sharpness / static_cast<float>(sum.crease_count) : 0.0F;
  if (sum.border_count > 0) {
    const bool is_corner = sum.border_count != 2 || sum.face_count == 1;
    if (border == Border::linear || is_corner) return old;
    const T on_border = 0.75F * old + 0.125F * sum.border;
    return sum.crease_count > 0 ? blend(on_border, old, sharpness) : on_border;
  }
  const T smooth = smoothly_moved_vertex(old, sum);
  if (sum.crease_count < 2) return smooth;
  return blend(smooth, sum.crease_count == 2 ? 0.75F * old + 0.125F * sum.creased : old, sharpness);
}

/// One step. New values: moved vertices, then edge points, then face points. Each corner becomes
/// the quadrilateral (vertex, edge point after it, face point, edge point before it).
template <class T>
Channel<T> subdivide(const Channel<T>& channel, std::span<const std::uint32_t> face_begin,
                     Border border, std::span<const float> sharpness) {
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
  const auto sums = vertex_sums<T>(channel, edges, face_points, face_begin, sharpness);
  for (std::size_t v = 0; v < channel.values.size(); ++v)
    result.values.push_back(moved_vertex(channel.values[v], sums[v], border));
  for (const MeshEdge& edge : edges.edges) {
    const T middle = 0.5F * (channel.values[edge.vertex[0]] + channel.values[edge.vertex[1]]);
    if (edge.face_count != 2) {
      result.values.push_back(middle);
      continue;
    }
    const T smooth = 0.5F * middle + 0.25F * (face_points[face_of_corner[edge.corner[0]]] +
                                              face_points[face_of_corner[edge.corner[1]]]);
    const float sharp = sharpness_of(edge, sharpness);
    result.values.push_back(sharp > 0.0F ? blend(smooth, middle, sharp) : smooth);
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
                        std::uint32_t MeshCorner::*index) {
  Channel<T> channel{.values = std::move(values), .indices = {}};
  if (!channel.values.empty())
    for (const MeshCorner& corner : mesh.corners) channel.indices.push_back(corner.*index);
  return channel;
}

/// Both halves of an edge are sharp for one step less than it was; no other new edge is.
CornerSharpness subdivide(const CornerSharpness& sharpness,
                          std::span<const std::uint32_t> face_begin) {
  CornerSharpness result;
  result.reserve(4 * sharpness.size());
  for (std::size_t f = 0; f + 1 < face_begin.size(); ++f)
    for (std::uint32_t c = face_begin[f]; c < face_begin[f + 1]; ++c) {
      const std::uint32_t before = c > face_begin[f] ? c - 1 : face_begin[f + 1] - 1;
      result.insert(result.end(), {std::max(sharpness[c] - 1.0F, 0.0F), 0.0F, 0.0F,
                                   std::max(sharpness[before] - 1.0F, 0.0F)});
    }
  return result;
}

CornerSharpness corner_sharpness(const PolygonMesh& mesh, const CreaseOptions& creases) {
  if (mesh.creases.empty() && !(creases.angle > 0.0)) return {};
  std::vector<std::uint32_t> positions;
  positions.reserve(mesh.corners.size());
  for (const MeshCorner& corner : mesh.corners) positions.push_back(corner.position);
  const MeshEdges edges = make_mesh_edges(mesh.face_begin, positions, mesh.positions.size());
  std::map<std::pair<std::uint32_t, std::uint32_t>, float> named;
  for (const MeshCrease& crease : mesh.creases) {
    float& sharpness = named[std::minmax(crease.a, crease.b)];
    sharpness = std::max(sharpness, crease.sharpness);
  }
  std::vector<float> of_edge(edges.edges.size());
  std::vector<std::uint32_t> face_of_corner(mesh.corners.size());
  for (std::uint32_t f = 0; f < face_count(mesh); ++f)
    for (std::size_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c) face_of_corner[c] = f;
  for (std::size_t e = 0; e < edges.edges.size(); ++e) {
    const MeshEdge& edge = edges.edges[e];
    if (const auto found = named.find(std::minmax(edge.vertex[0], edge.vertex[1]));
        found != named.end())
      of_edge[e] = found->second;
    else if (creases.angle > 0.0 && edge.face_count == 2) {
      const Vec3 a = doubled_area(mesh, face_of_corner[edge.corner[0]]);
      const Vec3 b = doubled_area(mesh, face_of_corner[edge.corner[1]]);
      if (std::atan2(length(cross(a, b)), dot(a, b)) >= creases.angle)
        of_edge[e] = creases.sharpness;
    }
  }
  CornerSharpness result(mesh.corners.size());
  for (std::size_t c = 0; c < result.size(); ++c) result[c] = of_edge[edges.edge_of_corner[c]];
  return result;
}

}  // namespace

PolygonMesh subdivide_catmull_clark(PolygonMesh mesh, int levels, const CreaseOptions& creases) {
  assert(0 <= levels && levels <= most_subdivisions);
  if (levels == 0 || face_count(mesh) == 0) return mesh;
  constexpr std::size_t most_corners = 400'000'000;
  if (mesh.corners.size() << (2 * levels) > most_corners)
    throw InvalidInput(mesh.name + ": " + std::to_string(face_count(mesh)) + " faces, subdivided " +
                       std::to_string(levels) +
                       " times, must not give more than 100 million faces");
  CornerSharpness sharpness = corner_sharpness(mesh, creases);
  Channel<Vec3f> positions = take_channel(mesh, mesh.positions, &MeshCorner::position);
  Channel<Vec2f> uvs = take_channel(mesh, mesh.uvs, &MeshCorner::uv);
  Channel<Vec3f> colors = take_channel(mesh, mesh.colors, &MeshCorner::color);
  for (int level = 0; level < levels; ++level) {
    positions = subdivide<Vec3f>(positions, mesh.face_begin, Border::smooth, sharpness);
    if (!uvs.values.empty())
      uvs = subdivide<Vec2f>(uvs, mesh.face_begin, Border::linear, sharpness);
    if (!colors.values.empty())
      colors = subdivide<Vec3f>(colors, mesh.face_begin, Border::linear, sharpness);
    if (!sharpness.empty()) sharpness = subdivide(sharpness, mesh.face_begin);
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
    if (!colors.values.empty()) mesh.corners[c].color = colors.indices[c];
  }
  mesh.positions = std::move(positions.values);
  mesh.uvs = std::move(uvs.values);
  mesh.colors = std::move(colors.values);
  mesh.creases.clear();
  mesh.normals.clear();
  return mesh;
}

}  // namespace lamina
