// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace lamina::detail {

/// Columns that are summed at a time; what follows the last row is read up to so many.
inline constexpr std::size_t summed_columns = 16;

/// Sums over rows of their weight times each column.
/// @param rows     [row][column], with `summed_columns` numbers behind them
/// @param weights  [row]
/// @param sums     [column], to the next multiple of `summed_columns`
void sum_rows(const double* rows, std::size_t row_count, std::size_t columns, const double* weights,
              double* sums);

/// Sums rows by three weights at once, [row][3], to [3][column] with `stride` between the three.
void sum_rows_by_three(const double* rows, std::size_t row_count, std::size_t columns,
                       const double* weights, double* sums, std::size_t stride);

}  // namespace lamina::detail
