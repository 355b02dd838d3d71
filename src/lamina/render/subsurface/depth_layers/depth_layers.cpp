// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/depth_layers/depth_layers.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lamina/scene/surface/surface_point.h"

namespace lamina {
namespace {

// Segments that are not halved, over the tolerance.
constexpr float shortest_over_tolerance = 10.0f;
// By so much of it a depth may be too large: where all of the surface is as far, as in the middle
// of a ball, the exact one takes long. Surely below all boundaries of layers it matters less.
constexpr float slack = 1e-3f, slack_below = 0.03f;

}  // namespace

DepthLayers::DepthLayers(const RayGeometry& geometry, const std::vector<Mesh>& meshes,
                         std::uint32_t material, const Thickness& thickness,
                         const NodeLattice& lattice, float tolerance)
    : geometry_(geometry),
      meshes_(meshes),
      material_(material),
      grid_(thickness.grid),
      tops_(1, {0.0f}),
      has_maps_below_(thickness.has_maps_below),
      lattice_(lattice) {
  float thinnest = infinity;
  for (const std::vector<float>& layer : thickness.layers) {
    const std::vector<float>& above = tops_.back();
    std::vector<float> top(std::max(above.size(), layer.size()));
    for (std::size_t i = 0; i < top.size(); ++i)
      top[i] = above[above.size() > 1 ? i : 0] + layer[layer.size() > 1 ? i : 0];
    thinnest = std::min(thinnest, std::accumulate(layer.begin(), layer.end(), 0.0f) /
                                      static_cast<float>(layer.size()));
    tops_.push_back(std::move(top));
  }
  for (const std::vector<float>& top : tops_) {
    const auto [least, most] = std::ranges::minmax(top);
    range_.push_back({least, most});
  }
  if (count() > 1 || has_maps_below_)
    for (const Mesh& mesh : meshes_) {
      const bool has_material = std::ranges::find(mesh.material, material_) != mesh.material.end();
      neighbors_.push_back(has_material ? find_triangle_neighbors(mesh.triangles)
                                        : TriangleNeighbors());
    }
  const float deepest = range_.back().most;
  if (count() > 1) {
    tolerance_ = tolerance * thinnest;
    shortest_ = shortest_over_tolerance * tolerance_;
    longest_above_ = 4.0f * deepest;
  }
  if (count() == 1 || has_maps_below_) return;
  reach_ = deepest + std::max(deepest, 4.0f * lattice_.spacing());
  nodes_ = LazyValues<Node>(lattice_.count());
}

DepthLayers::Node DepthLayers::node_at(std::size_t node) const {
  return nodes_.at(node, [&](std::size_t i) -> Node {
    const Hit hit = geometry_.closest_point(lattice_.position(i), reach_, material_, 0.0f);
    return {std::min(hit.distance, reach_), hit.mesh, hit.triangle};
  });
}

Hit DepthLayers::nearest_of(const Vec3f& p, std::uint32_t mesh, std::uint32_t triangle) const {
  const auto [a, b, c] = meshes_[mesh].triangles[triangle];
  const auto& positions = meshes_[mesh].positions;
  const Vec2f at = nearest_on_triangle(p, positions[a], positions[b], positions[c]);
  const Vec3f nearest =
      (1.0f - at.x - at.y) * positions[a] + at.x * positions[b] + at.y * positions[c];
  return {length(nearest - p), at.x, at.y, mesh, triangle};
}

Hit DepthLayers::nearest_around(const Vec3f& p, std::uint32_t mesh, std::uint32_t triangle) const {
  constexpr int most_steps = 16;
  const TriangleNeighbors& neighbors = neighbors_[mesh];
  Hit nearest = nearest_of(p, mesh, triangle);
  for (int step = 0; step < most_steps; ++step) {
    const Hit here = nearest;
    const std::array<bool, 3> is_on_edge = {here.v <= 0.0f, here.u + here.v >= 1.0f - 1e-6f,
                                            here.u <= 0.0f};
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const std::uint32_t next = neighbors[here.triangle][edge];
      if (!is_on_edge[edge] || next == no_neighbor || meshes_[mesh].material[next] != material_)
        continue;
      const Hit there = nearest_of(p, mesh, next);
      if (there.distance < nearest.distance) nearest = there;
    }
    if (nearest.triangle == here.triangle) break;
  }
  return nearest;
}

DepthLayers::Place DepthLayers::place_of(const Vec3f& p, const Hit& nearest) const {
  const SurfacePoint point = make_bare_surface_point(meshes_, nearest);
  const Mesh& mesh = meshes_[nearest.mesh];
  Place place{.depth = nearest.distance, .is_exact = true, .nearest = nearest};
  // Directions to what is too near are but rounding.
  place.outward =
      nearest.distance > 1e-5f * length(p) ? normalize(point.position - p) : point.geometric_normal;
  if (!mesh.uvs.empty()) {
    const auto [a, b, c] = mesh.triangles[nearest.triangle];
    place.uv = (1.0f - nearest.u - nearest.v) * mesh.uvs[a] + nearest.u * mesh.uvs[b] +
               nearest.v * mesh.uvs[c];
  }
  place.layer = layer_at(place.depth, place.uv);
  return place;
}

DepthLayers::Place DepthLayers::find(const Vec3f& p, const Place& near) const {
  // No farther than a triangle that is near: a query so narrow is quick.
  Hit known;
  if (near.is_exact) {
    known = nearest_around(p, near.nearest.mesh, near.nearest.triangle);
  } else if (!has_maps_below_) {
    const Node node = node_at(lattice_.nearest(p).node);
    if (node.depth < reach_) known = nearest_around(p, node.mesh, node.triangle);
  }
  const bool is_below = (1.0f - slack_below) * known.distance > range_.back().most;
  const float too_far = is_below && known.is_hit() ? slack_below : slack;
  const Hit hit = geometry_.closest_point(p, (1.0f - too_far) * known.distance, material_, too_far);
  return place_of(p, hit.is_hit() ? hit : known);
}

std::size_t DepthLayers::layer_at(float depth, Vec2f uv) const {
  std::size_t layer = count() - 1;
  while (layer > 0 && depth < range_[layer].least) --layer;
  while (layer > 0 && depth < range_[layer].most && depth < top(layer, uv)) --layer;
  return layer;
}

DepthLayers::Place DepthLayers::at(const Vec3f& p, const Place& near) const {
  if (has_maps_below_) return find(p, near);
  if (count() == 1) return {};
  // A node's depth tells that of all places around, as far as they can be from it.
  const NodeLattice::Nearest nearest = lattice_.nearest(p);
  const float least = node_at(nearest.node).depth - length(p - nearest.position);
  if (least > range_.back().most) return {.layer = count() - 1, .depth = least};
  return find(p, near);
}

DepthLayers::Place DepthLayers::at_surface(const Vec3f& p, const Hit& hit,
                                           const Place& near) const {
  if (count() == 1 && !has_maps_below_) return {};
  if (meshes_[hit.mesh].material[hit.triangle] != material_) return at(p, near);
  Hit nearest = hit;
  nearest.distance = 0.0f;
  return place_of(p, nearest);
}

/// Whether a boundary may lie on a segment between two places, as far as their depths say.
bool DepthLayers::may_cross(const Place& start, const Place& end, float length) const {
  if (start.layer != end.layer) return true;
  const auto gap = [&](const Place& place, std::size_t top) {
    return std::max({range_[top].least - place.depth, place.depth - range_[top].most, 0.0f});
  };
  const std::size_t layer = start.layer;
  return (layer > 0 && gap(start, layer) + gap(end, layer) < length) ||
         (layer + 1 < count() && gap(start, layer + 1) + gap(end, layer + 1) < length);
}

/// Whether depth is linear along a segment, and what maps say about thickness, too.
bool DepthLayers::is_straight(const Vec3f& direction, const Place& start, const Place& end,
                              float length) const {
  const float at_start = -dot(direction, start.outward), at_end = -dot(direction, end.outward);
  const float bend = 0.125f * std::abs(at_end - at_start) * length;
  const float off = std::abs(end.depth - start.depth - 0.5f * (at_start + at_end) * length);
  if (bend > tolerance_ || off > tolerance_) return false;
  const std::size_t deeper = std::min(std::max(start.layer, end.layer) + 1, count() - 1);
  for (std::size_t layer = std::min(start.layer, end.layer); layer <= deeper; ++layer)
    if (range_[layer].least < range_[layer].most)
      return std::abs(end.uv.x - start.uv.x) * static_cast<float>(grid_.width) < 1.0f &&
             std::abs(end.uv.y - start.uv.y) * static_cast<float>(grid_.height) < 1.0f;
  return true;
}

std::optional<DepthLayers::Crossing> DepthLayers::first_crossing(const Ray& ray, const Place& start,
                                                                 float length,
                                                                 const Place& end) const {
  if (count() == 1 || !may_cross(start, end, length)) return std::nullopt;
  const auto point = [&](float t) { return ray.origin + t * ray.direction; };
  if (!start.is_exact) return first_crossing(ray, find(point(0.0f), end), length, end);
  if (!end.is_exact) return first_crossing(ray, start, length, find(point(length), start));
  if (length > shortest_ && !is_straight(ray.direction, start, end, length)) {
    const float half = 0.5f * length;
    const Place middle = find(point(half), start);
    if (auto crossing = first_crossing(ray, start, half, middle)) return crossing;
    auto crossing = first_crossing({point(half), ray.direction}, middle, length - half, end);
    if (crossing) crossing->distance += half;
    return crossing;
  }
  if (start.layer == end.layer) return std::nullopt;
  const bool goes_deeper = end.layer > start.layer;
  const std::size_t boundary = goes_deeper ? start.layer + 1 : start.layer;
  const float before = start.depth - top(boundary, start.uv);
  const float after = end.depth - top(boundary, end.uv);
  const float fraction = before == after ? 0.5f : std::clamp(before / (before - after), 0.0f, 1.0f);
  Crossing crossing{.distance = fraction * length};
  crossing.place = find(point(crossing.distance), fraction < 0.5f ? start : end);
  crossing.place.layer = goes_deeper ? boundary : boundary - 1;
  return crossing;
}

}  // namespace lamina
