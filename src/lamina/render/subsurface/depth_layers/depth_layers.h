// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "lamina/base/core/lazy_values.h"
#include "lamina/render/geometry/ray_geometry.h"
#include "lamina/render/subsurface/depth_layers/node_lattice.h"
#include "lamina/render/subsurface/depth_layers/texel_grid.h"
#include "lamina/render/subsurface/depth_layers/triangle_neighbors.h"

namespace lamina {

/// Layers inside meshes, by depth: the distance to the nearest point of the surface of one
/// material. They are as thick as maps say at the texture coordinates of that point. The last layer
/// fills what the others leave. Safe to use from any thread.
class DepthLayers {
 public:
  /// Thickness over texels; a layer that is as thick everywhere may have a single value.
  struct Thickness {
    TexelGrid grid;
    std::vector<std::vector<float>> layers;  ///< [layer but the last][texel] >= 0 [mm]
    bool has_maps_below = false;             ///< the last layer differs from place to place
  };
  /// @param geometry   of the meshes; both must outlive it
  /// @param lattice    over the meshes
  /// @param tolerance  of boundaries of layers, over the thickness of the thinnest
  DepthLayers(const RayGeometry& geometry, const std::vector<Mesh>& meshes, std::uint32_t material,
              const Thickness& thickness, const NodeLattice& lattice, float tolerance);

  struct Place {
    std::size_t layer = 0;
    float depth = 0.0f;  ///< at least [mm]
    /// The depth is not only a bound, and what follows is known. Else all around is the last layer,
    /// without maps.
    bool is_exact = false;
    Hit nearest;            ///< of the surface
    Vec3f outward;          ///< towards it, unit length: against the gradient of the depth
    Vec2f uv;               ///< there
    std::size_t texel = 0;  ///< one around there; drawn where light is scattered
  };
  [[nodiscard]] Place at(const Vec3f& p) const { return at(p, Place()); }
  /// @param near  a place beside it, which makes it quick
  [[nodiscard]] Place at(const Vec3f& p, const Place& near) const;
  /// At a point of the surface of any material.
  [[nodiscard]] Place at_surface(const Vec3f& p, const Hit& hit, const Place& near) const;

  /// Where a segment leaves the layer in which it starts.
  struct Crossing {
    float distance = 0.0f;  ///< from the start [mm]
    Place place;            ///< already in the next layer
  };
  /// The first crossing of a straight segment inside, if there is any.
  ///
  /// Depth is Lipschitz: far from boundaries nothing is to do. Near them the segment is halved
  /// until depth is linear along it, by its gradients at both ends, to the tolerance.
  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, const Place& start,
                                                       float length, const Place& end) const;

  /// The parts that layers cut a segment into: calls `on_part(place, part)` and, where one ends,
  /// `on_crossing(layer, crossing)`, until either returns false.
  template <class OnPart, class OnCrossing>
  void for_parts(Ray ray, Place here, float length, const Place& end, const OnPart& on_part,
                 const OnCrossing& on_crossing) const {
    for (int parts = 0; parts < most_parts; ++parts) {
      const std::optional<Crossing> crossing = first_crossing(ray, here, length, end);
      const float part = crossing ? crossing->distance : length;
      if (!on_part(here, part) || !crossing || !on_crossing(here.layer, *crossing)) return;
      ray.origin += part * ray.direction;
      length -= part;
      here = crossing->place;
    }
  }

  /// How far beside a boundary a place is surely in one layer [mm].
  [[nodiscard]] float nudge(const Vec3f& p) const {
    return std::max(0.4f * tolerance_, 4e-6f * length(p));
  }
  /// Segments in layers above the last one need not be longer: they end before [mm].
  [[nodiscard]] float longest_above() const { return longest_above_; }

  [[nodiscard]] std::size_t count() const { return tops_.size(); }
  [[nodiscard]] const TexelGrid& grid() const { return grid_; }
  /// Depth of a layer's upper boundary at a place [mm].
  [[nodiscard]] float top(std::size_t layer, Vec2f uv) const {
    return tops_[layer].size() == 1 ? tops_[layer][0] : grid_.around(uv).mean(tops_[layer]);
  }
  [[nodiscard]] float top_at(std::size_t layer, std::size_t texel) const {
    return tops_[layer][tops_[layer].size() > 1 ? texel : 0];
  }
  [[nodiscard]] float least_top(std::size_t layer) const { return range_[layer].least; }

 private:
  static constexpr float infinity = std::numeric_limits<float>::infinity();
  static constexpr int most_parts = 1000;
  struct Range {
    float least = 0.0f, most = 0.0f;
  };
  /// The nearest point to a node of the lattice, which is nearly that of places around.
  struct Node {
    float depth = 0.0f;
    std::uint32_t mesh = 0, triangle = 0;
  };
  [[nodiscard]] Node node_at(std::size_t node) const;
  [[nodiscard]] Hit nearest_of(const Vec3f& p, std::uint32_t mesh, std::uint32_t triangle) const;
  /// From a triangle on to neighbours that are nearer, as far as that goes.
  [[nodiscard]] Hit nearest_around(const Vec3f& p, std::uint32_t mesh,
                                   std::uint32_t triangle) const;
  [[nodiscard]] Place place_of(const Vec3f& p, const Hit& nearest) const;
  [[nodiscard]] Place find(const Vec3f& p, const Place& near) const;
  [[nodiscard]] std::size_t layer_at(float depth, Vec2f uv) const;
  [[nodiscard]] bool may_cross(const Place& start, const Place& end, float length) const;
  [[nodiscard]] bool is_straight(const Vec3f& direction, const Place& start, const Place& end,
                                 float length) const;

  const RayGeometry& geometry_;
  const std::vector<Mesh>& meshes_;
  std::uint32_t material_;
  std::vector<TriangleNeighbors> neighbors_;  ///< [mesh], empty of those without the material
  TexelGrid grid_;
  std::vector<std::vector<float>> tops_;  ///< [layer][texel]
  std::vector<Range> range_;              ///< [layer] of its tops
  bool has_maps_below_;
  float reach_ = 0.0f;  ///< of nodes: depths beyond are not told apart [mm]
  float tolerance_ = 0.0f, shortest_ = 0.0f, longest_above_ = infinity;  ///< of segments [mm]
  NodeLattice lattice_;
  mutable LazyValues<Node> nodes_;
};

}  // namespace lamina
