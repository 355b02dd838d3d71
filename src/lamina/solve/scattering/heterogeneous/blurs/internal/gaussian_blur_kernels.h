// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

// The loops over texels of gaussian_blurs.cpp, compiled for each instruction set and chosen at run
// time. Results differ between processors by rounding only.

namespace lamina::detail {

/// Numbers that a row must have to either side of it where a kernel says "framed".
inline constexpr std::size_t frame = 16;

/// T: float or double.
template <class T>
struct BlurKernels {
  using Row = const T*;
  using Rows = std::span<const T* const>;

  /// sum[x] = taps[0] centre[x] + sum over n of taps[n] (before_n[x] + after_n[x]), where rows are
  /// before_r .. centre .. after_r.
  void (*combine_rows)(Rows rows, std::span<const float> taps, T* sum, std::size_t size);

  /// Convolves along a framed row, which reaches taps.size() - 1 <= frame to either side.
  void (*convolve_row)(Row row, std::span<const float> taps, T* result, std::size_t size);

  /// sum[x] += row[x] * polynomial(coordinate[x]).
  void (*add_times_polynomial)(Row row, Row coordinate, std::span<const T> coefficients, T* sum,
                               std::size_t size);

  /// Adds as add_times_polynomial, and slope[x] += row[x] * polynomial'(coordinate[x]).
  void (*add_times_polynomial_and_slope)(Row row, Row coordinate, std::span<const T> coefficients,
                                         T* sum, T* slope, std::size_t size);

  /// sum[x] += row[x] * sum over p of coefficients[p] modes[p][x]; at least one.
  void (*add_times_modes)(Row row, Rows modes, std::span<const T> coefficients, T* sum,
                          std::size_t size);

  /// Every second place of a framed row of 2 * size, weighted 1 3 3 1 over 8 around it.
  void (*halve_row)(Row row, T* result, std::size_t size);

  /// A framed row of half the size brought to this one: 3/4 of the nearer place, 1/4 of the next.
  /// @param size  even.
  void (*double_row)(Row row, T* result, std::size_t size);

  /// sum[x] += weight row[x].
  void (*add_row)(Row row, T weight, T* sum, std::size_t size);

  /// result[x] = row[x] factors[x]; result may be row.
  void (*multiply_row)(Row row, Row factors, T* result, std::size_t size);

  /// sum[x] += sum over p of coordinate[x]^p rows[p][x].
  void (*add_polynomial)(Rows rows, Row coordinate, T* sum, std::size_t size);

  /// Adds as add_polynomial, and slope[x] += sum over p of p coordinate[x]^(p-1) rows[p][x].
  void (*add_polynomial_and_slope)(Rows rows, Row coordinate, T* sum, T* slope, std::size_t size);

  /// sum[x] += sum over p of modes[p][x] rows[p][x]; at least as many modes as rows.
  void (*add_products)(Rows rows, Rows modes, T* sum, std::size_t size);
};

/// Kernels of the processor.
template <class T>
[[nodiscard]] const BlurKernels<T>& blur_kernels();

}  // namespace lamina::detail
