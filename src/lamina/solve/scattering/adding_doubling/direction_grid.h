// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lamina {

/// Directions of light in a stack of layers, the same set for all of them.
///
/// A direction is known by p = ior * sin(theta), which Snell's law conserves, so that a smooth
/// interface maps each node to itself. The axis of p is cut at every index of the stack, since
/// Fresnel's law has a square root at the critical angles. Each segment [ior_below, ior_above] has
/// a Gauss-Legendre rule in the cosine inside the medium of its upper index, where everything is
/// smooth. Nodes are sorted by segment: a medium uses the nodes before active_count(grid, ior),
/// in all others light does not propagate there.
///
/// Beams and directions to look from are extra nodes of negligible weight.
struct DirectionGrid {
  std::vector<double> p;        ///< [node], ior * sin(theta)
  std::vector<double> etendue;  ///< [node] weight: sum of etendue * f is the integral of f 2p dp
  std::vector<double> segment_ior;  ///< [node] upper index of the node's segment
  std::vector<double> segment_cos;  ///< [node] cosine of the direction in that medium
  std::vector<std::size_t> extra;   ///< [extra] the node of each extra direction, in order given

  [[nodiscard]] std::size_t size() const { return p.size(); }
};

/// A direction of its own, given in one of the media.
struct GridDirection {
  double ior, sin, cos;  ///< of the medium; of the angle from the normal
};

/// @param theta  in [0, pi/2). Beyond 90 degrees less 6e-9 the cosine is taken as 1e-10: an extra
///               node at a smaller one would not be negligible. A slab's totals change by 1e-9.
[[nodiscard]] GridDirection direction_in(double ior, double theta);

/// Etendue weight of an extra node: it does not disturb the others, yet its rows keep their digits.
inline constexpr double extra_node_etendue = 1e-20;

/// @param indices  the refractive indices of all media, > 0; any order, repeats allowed.
/// @param nodes    of the first segment, >= 2; the narrower ones have fewer.
/// @param extra    further directions, each in one of these media (to 1e-9 of its index).
[[nodiscard]] DirectionGrid make_direction_grid(std::span<const double> indices, int nodes,
                                                std::span<const GridDirection> extra = {});

/// How many nodes, from the first, are directions of a medium of this index.
[[nodiscard]] std::size_t active_count(const DirectionGrid& grid, double ior);

/// Cosine of the node's direction in a medium of this index, in (0, 1]; it must be active there.
/// Written so that nothing cancels near the critical angles.
[[nodiscard]] double cosine(const DirectionGrid& grid, std::size_t node, double ior);

}  // namespace lamina
