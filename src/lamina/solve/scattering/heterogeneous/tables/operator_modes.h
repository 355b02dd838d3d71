// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/tables/state_lattice.h"

namespace lamina::detail {

/// [row][column]
using ValuesOfRows = std::vector<std::vector<double>>;

/// Spatial frequencies at which operators are compared [1/mm].
inline constexpr std::array<double, 17> compared_frequencies = {
    0.0, 0.1, 0.2, 0.4, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 20.0, 40.0, 80.0, 160.0};

/// Transform of a sum of Gaussians at a spatial frequency [1/mm].
[[nodiscard]] double transform(const std::vector<double>& weights,
                               const std::vector<double>& variances, double k);

/// The operators of a layer at all nodes of a lattice as sums of few: at node n operator o is the
/// sum over modes m of at_nodes[m][n] weights[o][m].
struct OperatorModes {
  ValuesOfRows at_nodes;                ///< [mode][node]
  std::array<ValuesOfRows, 4> weights;  ///< [operator][mode][gaussian]; empty: no operator
};

/// Finds modes by Gram and Schmidt's process with pivots: the node that is missed most becomes the
/// next mode, until all transforms at compared_frequencies are met to `tolerance` times the largest
/// total of the operator.
///
/// @param at_nodes  [operator][node][gaussian]; empty: no operator
[[nodiscard]] OperatorModes find_modes(const std::array<ValuesOfRows, 4>& at_nodes,
                                       const std::vector<double>& variances, double tolerance);

}  // namespace lamina::detail
