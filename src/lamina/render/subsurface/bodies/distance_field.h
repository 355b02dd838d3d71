// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lamina/base/core/lazy_values.h"
#include "lamina/base/core/vec.h"
#include "lamina/render/geometry/ray_geometry.h"
#include "lamina/render/subsurface/depth_layers/node_lattice.h"

namespace lamina {

/// Directions, a few of them.
struct FewNormals {
  static constexpr std::size_t most = 8;
  std::array<Vec3f, most> at;
  std::size_t count = 0;
};

/// Whether two of them differ clearly, by more than some 25 degrees.
[[nodiscard]] inline bool differ(const Vec3f& a, const Vec3f& b) { return !(dot(a, b) > 0.9f); }

/// A distance field: lower bounds of the distance to the nearest surface, at the nodes of a
/// lattice. A segment within the empty balls around its two ends needs no ray. A node is computed
/// when it is first asked for. Safe to use from any thread.
class DistanceField {
 public:
  /// Geometry and meshes must outlive it.
  /// @param wide_lattice  of `normals_near`
  DistanceField(const RayGeometry& geometry, const std::vector<Mesh>& meshes,
                const NodeLattice& lattice, const NodeLattice& wide_lattice);

  /// Lower bound [mm]; may be negative near a surface.
  [[nodiscard]] float at(const Vec3f& p) const {
    const NodeLattice::Nearest nearest = lattice_.nearest(p);
    return step_ * static_cast<float>(steps_at(nearest.node) - 1) - length(p - nearest.position);
  }
  /// About the outward normal of the surface that is nearest; 0 far inside.
  [[nodiscard]] Vec3f nearest_normal(const Vec3f& p) const;
  /// The outward normals of surfaces near p that differ clearly, those of the nearest first: both
  /// faces of an edge, both sides of a sheet. The same for all points around a node.
  [[nodiscard]] FewNormals normals_near(const Vec3f& p) const;

 private:
  /// One more than the distance in steps.
  [[nodiscard]] int steps_at(std::size_t node) const {
    const std::uint8_t steps = steps_[node].load(std::memory_order_acquire);
    return steps > 0 ? steps : measure(node);
  }
  int measure(std::size_t node) const;
  [[nodiscard]] Vec3f normal_of_node(std::size_t node) const;

  const RayGeometry& geometry_;
  const std::vector<Mesh>& meshes_;
  NodeLattice lattice_;
  float step_;  ///< [mm]
  // A byte for the distance, so that the caches hold those of all nodes; 0: not computed yet.
  mutable std::vector<std::atomic<std::uint8_t>> steps_;
  mutable std::vector<std::atomic<std::uint32_t>> normals_;  ///< 10 bits for each coordinate
  NodeLattice wide_lattice_;                                 ///< of `near_`
  mutable LazyValues<FewNormals> near_;
};

}  // namespace lamina
