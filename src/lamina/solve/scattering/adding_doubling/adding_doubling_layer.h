// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_matrix.h"
#include "lamina/solve/scattering/adding_doubling/direction_grid.h"

namespace lamina::detail {

/// A phase function cut to the moments that a grid can carry. What the series lacks, a sharp peak,
/// goes exactly straight on or straight back (delta-M).
///
/// Source: [Wiscombe1977] Eqs. 11-14; the backward peak is its mirror image.
struct TruncatedPhase {
  std::vector<double> moments;  ///< [l] of what is left, moments[0] = 1
  double forward_peak = 0.0;    ///< fraction of the scattering that goes straight on
  double backward_peak = 0.0;   ///< and that goes straight back
};

/// Keeps at most `count` moments (even, >= 2), fewer where the rest vanishes.
[[nodiscard]] TruncatedPhase truncate(const PhaseFunction& phase, int count);

/// How many moments the nodes of a medium can carry.
[[nodiscard]] int carried_moments(const DirectionGrid& grid, double ior);

/// One layer on a direction grid: all that does not depend on the azimuthal mode.
struct GridLayer {
  double sigma_a = 0.0;     ///< [1/mm]
  double extinction = 0.0;  ///< scattering and absorption as the medium has them [1/mm]
  double sigma_t = 0.0;     ///< extinction, the forward peak left out [1/mm]
  double sigma_s = 0.0;     ///< scattering by the truncated phase function [1/mm]
  double backward = 0.0;    ///< scattering straight back [1/mm]
  double thickness = 0.0;
  double ior = 1.0;
  std::size_t reach = 0;        ///< light of nodes from here on never gets into this layer
  std::vector<double> moments;  ///< of the truncated phase function
  std::vector<double> cos;      ///< [active node]
  std::vector<double> weight;   ///< [active node] sqrt(etendue) / (ior * cos)
  /// [active node] What the quadrature loses of the light scattered from this direction. It goes
  /// straight on, in every azimuthal mode, so that energy is conserved to rounding.
  std::vector<double> defect;
};

/// @param ior    the layer's index as it is among those of the grid.
/// @param reach  largest p that outside or a scattering layer can bring into this one.
[[nodiscard]] GridLayer make_grid_layer(const Layer& layer, double ior, double reach,
                                        const DirectionGrid& grid);

/// Extinction that the node's unscattered light sees on the grid [1/mm].
[[nodiscard]] inline double node_extinction(const GridLayer& layer, std::size_t node) {
  return layer.sigma_t - layer.sigma_s * layer.defect[node];
}

/// Legendre functions sqrt((l-m)!/(l+m)!) P_l^m(x) for l = m .. count - 1, of one x per row.
/// Returned as [row][l - m]; empty if m >= count.
[[nodiscard]] std::vector<double> legendre_functions(int count, int m,
                                                     const std::vector<double>& x);

/// The phase function of azimuthal mode m between the layer's nodes: forward into the same
/// hemisphere, backward into the other. Sum over l of (2l + 1) moment_l P_l^m P_l^m.
struct PhaseMode {
  Matrix forward, backward;
};
[[nodiscard]] PhaseMode phase_mode(const std::vector<double>& moments,
                                   const std::vector<double>& cos, int m);

/// Reflection and transmission of a layer for one azimuthal mode, on its active nodes.
struct LayerOperators {
  Matrix reflection, transmission;
};
[[nodiscard]] LayerOperators layer_operators(const GridLayer& layer, int m);

/// The equation of transfer on the layer's nodes, as in SlabProblem.
struct TransferMatrices {
  Matrix forward, backward;
};
[[nodiscard]] TransferMatrices transfer_matrices(const GridLayer& layer, int m);

/// From which thickness, and how often, a layer that scatters is doubled. Points to `transfer`.
[[nodiscard]] SlabProblem slab_problem(const GridLayer& layer, const TransferMatrices& transfer);

/// Square roots of the nodes' etendues, for SlabProblem::conserved.
[[nodiscard]] std::vector<double> root_etendues(const GridLayer& layer);

/// For each layer the largest p that outside, a scattering layer or a rough boundary can bring into
/// it. Directions beyond would be caught in a clear layer for ever.
///
/// @param interfaces   the top of each layer, and what is under the last one.
/// @param ior          above, of each layer, below.
/// @param from_ground  whether light comes back from below.
[[nodiscard]] std::vector<double> reach_of_layers(std::span<const Layer> layers,
                                                  std::span<const Interface> interfaces,
                                                  const std::vector<double>& ior, bool from_ground);

}  // namespace lamina::detail
