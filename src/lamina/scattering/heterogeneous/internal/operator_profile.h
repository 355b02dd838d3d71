// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lamina/scattering/heterogeneous/gaussian_tables.h"

namespace lamina::detail {

/// The four equidistant rows around a place, and their shares in Lagrange's polynomial.
struct FourRows {
  std::size_t first;
  std::array<double, 4> share;
};
[[nodiscard]] FourRows four_rows(double place, std::size_t rows);

/// What a whole stack reflects of light entering as J0(k r), over what it reflects at k = 0, by
/// radiative transfer; [row of the first layer's absorption][k]. The layers below are at their
/// reference absorption.
///
/// Solved for 8 absorptions of .02 to 40/mm and 12 frequencies up to 24/mm; beyond these it stays
/// as at the nearest. About a second of CPU time.
[[nodiscard]] std::vector<std::vector<double>> transfer_stack_shapes(
    const MappedStack& stack, std::span<const double> reference_sigma_a,
    const GaussianTableGrid& grid, std::span<const double> k);

/// Beyond this frequency the shapes are those at it [1/mm].
inline constexpr double highest_transfer_frequency = 24.0;

}  // namespace lamina::detail
