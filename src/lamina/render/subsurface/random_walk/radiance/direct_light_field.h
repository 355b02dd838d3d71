// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lamina/base/core/lazy_values.h"
#include "lamina/render/subsurface/depth_layers/node_lattice.h"
#include "lamina/render/subsurface/random_walk/interior/manifold_next_event.h"

namespace lamina {

/// Direct light at a point inside: unscattered since it left a light.
template <int N>
struct DirectFluence {
  BandValues<N> fluence;          ///< radiance integrated over directions
  Vec3f to_light;                 ///< mean direction, length at most 1
  float weight = 0.0f;            ///< 0: absent, no node near is inside
  float deviation = 0.0f;         ///< of single estimates from the mean, at most
  BandValues<N> reduced_fluence;  ///< if it were attenuated by the reduced extinction
};

/// The direct part of a precomputed radiance field: means of next-event estimates around the nodes
/// of a lattice, interpolated. A node is computed when it is first asked for. Safe to use from any
/// thread.
template <int N>
class DirectLightField {
 public:
  using Bands = BandValues<N>;

  /// @param reduced_sigma_t  that of DirectFluence::reduced_fluence
  /// @param free_path        spacing of nodes [mm]
  DirectLightField(const BodyInterior<N>& interior, const ManifoldNextEvent<N>& next_event,
                   const Bands& sigma_t, const Bands& reduced_sigma_t, float free_path);

  /// From the nodes around, each along its beam.
  [[nodiscard]] DirectFluence<N> at(const Vec3f& p, const LightGatherer<N>& light) const;

 private:
  /// The mean of points around a node.
  struct Node {
    DirectFluence<N> light;
    Vec3f position;  ///< of their middle
  };
  [[nodiscard]] Node compute_node(std::size_t node, const LightGatherer<N>& light) const;

  const BodyInterior<N>& interior_;
  const ManifoldNextEvent<N>& next_event_;
  Bands sigma_t_, reduced_sigma_t_;
  bool is_reduced_;  ///< the extinction differs from the reduced one
  NodeLattice lattice_;
  mutable LazyValues<Node> nodes_;
};

}  // namespace lamina
