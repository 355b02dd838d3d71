// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lamina/layers/optics/rough/rough_interface.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_matrix.h"
#include "lamina/solve/scattering/adding_doubling/direction_grid.h"

namespace lamina::detail {

/// One side of a rough boundary on a direction grid. Its frame has +z towards its medium, as
/// FacetWalk has it: light "up" leaves. Light goes on from facet to facet in the directions of the
/// regular nodes alone: the nodes up, then the nodes down. It arrives from any node.
struct FacetSide {
  double ior = 1.0;
  RoughInterface<double> interface;  ///< as seen from here
  std::vector<std::size_t> regular;  ///< the nodes that are no extra ones
  std::vector<std::size_t> extra;    ///< the others
  std::vector<double> cos, lambda;   ///< [node]; Smith's Lambda
};
[[nodiscard]] FacetSide make_facet_side(const DirectionGrid& grid, const Interface& boundary,
                                        double ior, double ior_beyond);

/// Flux that one facet sends on, per flux that meets it, for one azimuthal mode. The narrow lobe of
/// a facet is shared out among the nodes by Lagrange's polynomials, so that its integral with
/// smooth radiance is exact however narrow it is.
struct FacetOperators {
  Matrix reflection, transmission;  ///< [to direction here, beyond][from direction here]
  Matrix arriving_reflection, arriving_transmission;  ///< [to direction here, beyond][from node]
};

/// For `count` azimuthal modes from `first` on, [mode]. One lattice of facets serves them all.
[[nodiscard]] std::vector<FacetOperators> facet_operators(const DirectionGrid& grid,
                                                          const FacetSide& here,
                                                          const FacetSide& beyond, int first,
                                                          int count);

}  // namespace lamina::detail
