// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/spectrum/band_values.h"
#include "lamina/solve/scattering/heterogeneous/blurs/cell_graph.h"
#include "lamina/solve/scattering/heterogeneous/blurs/gaussian_blurs.h"

namespace lamina {

/// Numbers of all bands on the cells of a surface.
template <int N>
using CellField = std::vector<BandValues<N>>;

/// How many blurs a graph of cells offers: heat that spreads over the surface for some time, which
/// on a plane makes Gaussians. Wide ones run on coarse levels. Every blur keeps the light, across
/// seams too, and those of the finest level are their own adjoints. The first is none.
[[nodiscard]] std::size_t scale_count(const CellGraph& graph);

/// A matrix, [variance][scale]: each Gaussian as the sum of the graph's blurs that comes next to it
/// on a lattice of typical cells.
///
/// @param variances  [mm²], >= 0.
[[nodiscard]] std::vector<double> cell_scales_of_gaussians(const CellGraph& graph,
                                                           std::span<const double> variances);

/// TexelBasis of all bands at once: powers of a coordinate, or, where there are any, modes.
template <int N>
struct CellBasis {
  CellField<N> coordinate;
  std::vector<CellField<N>> modes = {};
};

/// MappedOperator of all bands at once.
template <int N>
struct CellOperator {
  std::size_t terms = 0;
  std::vector<BandValues<N>> weights;  ///< [term][scale]
  std::vector<BandValues<N>> totals;   ///< [term]
};

/// Sum over the functions of a basis at a cell, by coefficients that `coefficient(term)` gives.
template <int N, class Coefficient>
[[nodiscard]] BandValues<N> basis_sum(const CellBasis<N>& basis, std::size_t cell,
                                      std::size_t terms, const Coefficient& coefficient) {
  if (!basis.modes.empty()) {
    BandValues<N> sum = basis.modes[0][cell] * coefficient(0);
    for (std::size_t p = 1; p < terms; ++p) sum += basis.modes[p][cell] * coefficient(p);
    return sum;
  }
  BandValues<N> sum = coefficient(terms - 1);
  for (std::size_t p = terms - 1; p-- > 0;) sum = sum * basis.coordinate[cell] + coefficient(p);
  return sum;
}

/// Applies several operators to light, as `apply_operators` does on a grid.
///
/// @param basis  a value for each cell.
template <int N>
[[nodiscard]] std::vector<CellField<N>> apply_cell_operators(
    const CellGraph& graph, const CellField<N>& input, const CellBasis<N>& basis,
    std::span<const CellOperator<N>* const> operators);

/// Means of a field over the cells of a level that is at least as coarse.
/// @param level  the field's own
template <int N>
[[nodiscard]] CellField<N> mean_on_level(const CellGraph& graph, CellField<N> field,
                                         std::size_t level, std::size_t coarser);

/// A field of a level on the finest one, smooth between its cells. It keeps the total.
template <int N>
[[nodiscard]] CellField<N> smooth_on_finest(const CellGraph& graph, CellField<N> field,
                                            std::size_t level);

}  // namespace lamina
