// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "lamina/core/lazy_values.h"
#include "lamina/render/geometry/ray_geometry.h"
#include "lamina/render/subsurface/random_walk/internal/node_lattice.h"

namespace lamina {

/// Layers inside meshes, by depth: the distance to the nearest point of the surface of one
/// material. The last layer fills what the others leave. Safe to use from any thread.
class DepthLayers {
 public:
  /// @param geometry   of the meshes; both must outlive it
  /// @param thickness  of all layers but the last [mm], > 0
  /// @param lattice    over the meshes
  DepthLayers(const RayGeometry& geometry, const std::vector<Mesh>& meshes, std::uint32_t material,
              const std::vector<float>& thickness, const NodeLattice& lattice);

  struct Place {
    std::size_t layer = 0;
    float clear = infinity;  ///< radius of a ball around the place in which the layer goes on,
                             ///< unless the surface is nearer [mm]
    float depth = 0.0f;      ///< at least [mm]
    bool is_exact = false;   ///< the depth is not only a bound
  };
  [[nodiscard]] Place at(const Vec3f& p) const;

  /// The parts that layers cut a ray into, from its start on: calls `on_part(layer,
  /// length)` until that returns false or the length ends. All of it must be inside.
  ///
  /// Sphere tracing: balls around points of the ray, each within one layer; where such a ball gets
  /// too small, a short step whose depth is taken as linear.
  template <class OnPart>
  void for_parts(const Ray& ray, const Place& start, float length, const OnPart& on_part) const;

  /// Towards the surface, unit length: the normal of the boundary between layers.
  [[nodiscard]] Vec3f outward(const Vec3f& p) const;
  /// How far beside a boundary a place is surely in one layer [mm].
  [[nodiscard]] float nudge(const Vec3f& p) const {
    return std::max(0.04f * short_step_, 4e-6f * length(p));
  }

  [[nodiscard]] std::size_t count() const { return tops_.size(); }
  /// Depth of a layer's upper boundary [mm].
  [[nodiscard]] float top(std::size_t layer) const { return tops_[layer]; }

 private:
  static constexpr float infinity = std::numeric_limits<float>::infinity();
  /// The nearest point to a node of the lattice, which is nearly that of places around.
  struct Node {
    float depth = 0.0f;
    std::uint32_t mesh = 0, triangle = 0;
  };
  [[nodiscard]] Node find_node(std::size_t node) const;
  [[nodiscard]] float find_depth(const Vec3f& p) const;
  [[nodiscard]] std::size_t layer_at(float depth) const;
  [[nodiscard]] float clear_between(std::size_t layer, float least, float most) const;

  const RayGeometry& geometry_;
  const std::vector<Mesh>& meshes_;
  std::uint32_t material_;
  std::vector<float> tops_;
  float reach_ = 0.0f;       ///< depths beyond are not told apart [mm]
  float short_step_ = 0.0f;  ///< [mm]
  NodeLattice lattice_;
  mutable LazyValues<Node> nodes_;
};

template <class OnPart>
void DepthLayers::for_parts(const Ray& ray, const Place& start, float length,
                            const OnPart& on_part) const {
  Place here = start;
  for (float t = 0.0f; t < length;) {
    if (here.clear >= std::min(short_step_, length - t)) {
      const float step = std::min(here.clear, length - t);
      if (!on_part(here.layer, step)) return;
      t += step;
      if (t < length) here = at(ray.origin + t * ray.direction);
      continue;
    }
    const float step = std::min(short_step_, length - t);
    const float before = here.is_exact ? here.depth : find_depth(ray.origin + t * ray.direction);
    const float after = find_depth(ray.origin + (t + step) * ray.direction);
    const std::size_t first = layer_at(before), second = layer_at(after);
    const float boundary = tops_[std::max(first, second)];
    const float fraction =
        first == second ? 1.0f : std::clamp((boundary - before) / (after - before), 0.0f, 1.0f);
    if (!on_part(first, fraction * step)) return;
    if (first != second && !on_part(second, (1.0f - fraction) * step)) return;
    t += step;
    here = {second, clear_between(second, after, after), after, true};
  }
}

}  // namespace lamina
