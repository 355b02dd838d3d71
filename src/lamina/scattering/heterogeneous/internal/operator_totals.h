// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "lamina/scattering/heterogeneous/gaussian_tables.h"

namespace lamina::detail {

/// Totals of R+, T+, R-, T- of a layer, each [row].
using LayerTotals = std::array<std::vector<double>, 4>;

/// Totals by adding-doubling as make_stack_tables explains them, [layer]. They are solved at
/// Chebyshev nodes of the logarithm of absorption and interpolated: to 1e-5 of incident light.
///
/// @param is_lit_evenly  from outside, else normally
[[nodiscard]] std::vector<LayerTotals> transfer_operator_totals(
    const MappedStack& stack, std::span<const double> reference_sigma_a,
    const GaussianTableGrid& grid, bool is_lit_evenly);

/// What the top and the bottom boundary of a layer turn back from inside.
[[nodiscard]] std::pair<double, double> boundary_reflectances(const MappedStack& stack,
                                                              std::size_t layer);

}  // namespace lamina::detail
