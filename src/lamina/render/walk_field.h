// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "lamina/core/band_values.h"
#include "lamina/core/vec.h"
#include "lamina/render/lazy_values.h"
#include "lamina/render/ray_geometry.h"

namespace lamina {

/// Nodes of a cubic lattice over a box.
class NodeLattice {
 public:
  /// @param spacing  of nodes [mm]; made wider if there were more than `most_nodes`
  NodeLattice(const Vec3f& low, const Vec3f& high, float spacing, double most_nodes);

  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
           static_cast<std::size_t>(size_[2]);
  }
  [[nodiscard]] float spacing() const { return spacing_; }
  [[nodiscard]] std::size_t nearest(const Vec3f& p) const {
    const Vec3f at = (p - low_) * (1.0f / spacing_) + Vec3f{0.5f, 0.5f, 0.5f};
    return index(within(at.x, 0), within(at.y, 1), within(at.z, 2));
  }
  [[nodiscard]] Vec3f position(std::size_t node) const {
    const auto nx = static_cast<std::size_t>(size_[0]), ny = static_cast<std::size_t>(size_[1]);
    return low_ + spacing_ * Vec3f{static_cast<float>(node % nx),
                                   static_cast<float>(node / nx % ny),
                                   static_cast<float>(node / (nx * ny))};
  }
  /// The eight nodes around a point and their weights, trilinear.
  struct Corners {
    std::array<std::size_t, 8> node;
    std::array<float, 8> weight;
  };
  [[nodiscard]] Corners corners(const Vec3f& p) const;

 private:
  [[nodiscard]] int within(float x, int axis) const {
    const int last = size_[static_cast<std::size_t>(axis)] - 1;
    return static_cast<int>(std::clamp(x, 0.0f, static_cast<float>(last)));
  }
  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(size_[0]) *
               (static_cast<std::size_t>(y) +
                static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(z));
  }

  Vec3f low_;
  float spacing_;
  std::array<int, 3> size_;
};

/// How far it is to the nearest surface, at least: a segment within two balls that hold none needs
/// no ray. Worked out where it is asked for. Safe to use from any thread.
class SafeDistances {
 public:
  /// All must outlive it.
  SafeDistances(const RayGeometry& geometry, const std::vector<Mesh>& meshes,
                const NodeLattice& lattice);

  [[nodiscard]] float at(const Vec3f& p) const {
    const std::size_t node = lattice_.nearest(p);
    return node_at(node).distance - length(p - lattice_.position(node));
  }
  /// About the outward normal of the surface that is nearest.
  [[nodiscard]] Vec3f nearest_normal(const Vec3f& p) const {
    return node_at(lattice_.nearest(p)).normal;
  }

 private:
  struct Node {
    float distance;
    Vec3f normal;
  };
  [[nodiscard]] Node node_at(std::size_t node) const;

  const RayGeometry& geometry_;
  const std::vector<Mesh>& meshes_;
  NodeLattice lattice_;
  mutable LazyValues<Node> nodes_;
};

/// About the light that comes to places straight from lamps, as paths need it to spare themselves
/// the search for a lamp: they add what is known here and correct it at random.
template <int N>
struct LampLight {
  BandValues<N> fluence;  ///< radiance integrated over directions
  Vec3f direction;        ///< mean of those towards the light, length at most 1
  float spread = 0.0f;    ///< of single estimates around the mean, at most
  float weight = 0.0f;    ///< 0: nothing is known
};

/// Lamp light at the nodes of a lattice. Safe to use from any thread.
template <int N>
class LampField {
 public:
  explicit LampField(const NodeLattice& lattice) : lattice_(lattice), nodes_(lattice.count()) {}

  [[nodiscard]] float spacing() const { return lattice_.spacing(); }

  /// @param make  of a node's number and position: its light; the same whoever calls it
  template <class Make>
  [[nodiscard]] LampLight<N> at(const Vec3f& p, const Make& make) const {
    const NodeLattice::Corners corners = lattice_.corners(p);
    LampLight<N> sum;
    for (std::size_t i = 0; i < 8; ++i) {
      const LampLight<N> light = nodes_.at(
          corners.node[i], [&](std::size_t node) { return make(node, lattice_.position(node)); });
      const float weight = corners.weight[i] * light.weight;
      sum.fluence += weight * light.fluence;
      sum.direction += weight * light.direction;
      sum.spread = std::max(sum.spread, light.spread);
      sum.weight += weight;
    }
    if (!(sum.weight > 0.0f)) return {};
    sum.fluence *= 1.0f / sum.weight;
    sum.direction *= 1.0f / sum.weight;
    return sum;
  }

 private:
  NodeLattice lattice_;
  mutable LazyValues<LampLight<N>> nodes_;
};

}  // namespace lamina
