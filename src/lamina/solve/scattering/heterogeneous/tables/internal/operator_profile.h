// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/tables/gaussian_tables.h"

namespace lamina::detail {

/// Shapes of what a whole stack reflects of light entering as J0(k r), over what it reflects at k =
/// 0, by radiative transfer; [node of the first layer's lattice][k]. The layers below are at their
/// reference states.
///
/// Solved for at most 8 states along one axis, 4 along each of two and 3 along each of more; of
/// absorption alone from .02 to 40/mm; and for 16 frequencies up to 200/mm. Beyond these it stays
/// as at the nearest. Two to three seconds of CPU time for 8 states.
/// @throws Interrupted if progress, which is told after each state, asks to stop
[[nodiscard]] std::vector<std::vector<double>> transfer_stack_shapes(
    const MappedStack& stack, std::span<const LayerState> reference, const StateLattice& lattice,
    std::span<const double> k, const Progress& progress);

/// Beyond this frequency the shapes are those at it [1/mm].
inline constexpr double highest_transfer_frequency = highest_fitted_frequency;

}  // namespace lamina::detail
