// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/internal/depth_layers.h"

#include "lamina/surface/surface_point.h"

namespace lamina {
namespace {

constexpr float short_over_thinnest = 0.05f;

}  // namespace

DepthLayers::DepthLayers(const RayGeometry& geometry, const std::vector<Mesh>& meshes,
                         std::uint32_t material, const std::vector<float>& thickness,
                         const NodeLattice& lattice)
    : geometry_(geometry), meshes_(meshes), material_(material), tops_(1, 0.0f), lattice_(lattice) {
  if (thickness.empty()) return;
  for (const float t : thickness) tops_.push_back(tops_.back() + t);
  short_step_ = short_over_thinnest * *std::ranges::min_element(thickness);
  reach_ = tops_.back() + std::max(tops_.back(), 4.0f * lattice_.spacing());
  nodes_ = LazyValues<Node>(lattice_.count());
}

DepthLayers::Node DepthLayers::find_node(std::size_t node) const {
  const Hit hit = geometry_.closest_point(lattice_.position(node), reach_, material_, 0.0f);
  return {std::min(hit.distance, reach_), hit.mesh, hit.triangle};
}

float DepthLayers::find_depth(const Vec3f& p) const {
  // No farther than the triangle that is nearest to the node: a query so narrow is quick.
  const Node node =
      nodes_.at(lattice_.nearest(p).node, [&](std::size_t i) { return find_node(i); });
  float most = reach_;
  if (node.depth < reach_) {
    const Mesh& mesh = meshes_[node.mesh];
    const auto [a, b, c] = mesh.triangles[node.triangle];
    const Vec3f &at_a = mesh.positions[a], &at_b = mesh.positions[b], &at_c = mesh.positions[c];
    const Vec2f at = nearest_on_triangle(p, at_a, at_b, at_c);
    most = std::min(most, length((1.0f - at.x - at.y) * at_a + at.x * at_b + at.y * at_c - p));
  }
  return std::min(geometry_.closest_point(p, most, material_, 0.0f).distance, most);
}

Vec3f DepthLayers::outward(const Vec3f& p) const {
  const Hit hit = geometry_.closest_point(p, reach_, material_, 0.0f);
  if (!hit.is_hit()) return {0, 0, 1};
  const SurfacePoint nearest = make_bare_surface_point(meshes_, hit);
  return hit.distance > 0.0f ? normalize(nearest.position - p) : nearest.geometric_normal;
}

std::size_t DepthLayers::layer_at(float depth) const {
  std::size_t layer = tops_.size() - 1;
  while (layer > 0 && depth < tops_[layer]) --layer;
  return layer;
}

/// How far it is from depths between two bounds to the boundaries of a layer, at least; < 0 if it
/// does not hold both.
float DepthLayers::clear_between(std::size_t layer, float least, float most) const {
  const float above = layer > 0 ? least - tops_[layer] : infinity;
  const float below = layer + 1 < tops_.size() ? tops_[layer + 1] - most : infinity;
  return std::min(above, below);
}

DepthLayers::Place DepthLayers::at(const Vec3f& p) const {
  if (tops_.size() == 1) return {};
  // A node's depth tells that of all places around, as far as they can be from it.
  const NodeLattice::Nearest nearest = lattice_.nearest(p);
  const float depth = nodes_.at(nearest.node, [&](std::size_t i) { return find_node(i); }).depth;
  const float distance = length(p - nearest.position);
  const float least = std::max(depth - distance, 0.0f);
  const float most = depth < reach_ ? depth + distance : infinity;
  const std::size_t layer = layer_at(least);
  const float clear = clear_between(layer, least, most);
  if (clear > 0.5f * lattice_.spacing()) return {layer, clear, least, false};
  const float exact = find_depth(p);
  const std::size_t exact_layer = layer_at(exact);
  return {exact_layer, clear_between(exact_layer, exact, exact), exact, true};
}

}  // namespace lamina
