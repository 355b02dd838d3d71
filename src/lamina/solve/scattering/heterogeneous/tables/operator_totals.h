// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/solve/scattering/heterogeneous/tables/mapped_stack.h"

namespace lamina::detail {

/// Totals of R+, T+, R-, T- of a layer, each [node].
using LayerTotals = std::array<std::vector<double>, 4>;

/// Totals by adding-doubling as make_stack_tables explains them, [layer]. They are solved at
/// Chebyshev points of the states and interpolated: to 1e-5 of incident light where only absorption
/// varies.
///
/// @param lattices       [layer] states of each layer
/// @param reference      [layer] what a layer is while the others vary
/// @param is_lit_evenly  from outside, else normally
/// @throws Interrupted if progress asks to stop
[[nodiscard]] std::vector<LayerTotals> transfer_operator_totals(
    const MappedStack& stack, std::span<const StateLattice> lattices,
    std::span<const LayerState> reference, bool is_lit_evenly, const Progress& progress);

/// Reflectances of the top and the bottom boundary of a layer from inside.
/// @param roughness  of the lit surface, if the layer is the first
[[nodiscard]] std::pair<double, double> boundary_reflectances(const MappedStack& stack,
                                                              std::size_t layer,
                                                              double roughness = 0.0);

/// A layer in one of its states.
[[nodiscard]] Layer solid_layer(const MappedStack& stack, std::size_t layer,
                                const LayerState& state);

}  // namespace lamina::detail
