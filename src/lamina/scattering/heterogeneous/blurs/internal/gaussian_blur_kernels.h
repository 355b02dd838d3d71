// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

// The loops over texels of gaussian_blurs.cpp, compiled for each instruction set and chosen at run
// time. Results differ between processors by rounding only.

namespace lamina::detail {

/// Floats that a row must have to either side of it where a kernel says "framed".
inline constexpr std::size_t frame = 16;

/// sum[x] = taps[0] centre[x] + sum over n of taps[n] (before_n[x] + after_n[x]), where rows are
/// before_r .. centre .. after_r.
void combine_rows(std::span<const float* const> rows, std::span<const float> taps, float* sum,
                  std::size_t size);

/// The same along a framed row, which reaches taps.size() - 1 <= frame to either side.
void convolve_row(const float* row, std::span<const float> taps, float* result, std::size_t size);

/// sum[x] += row[x] * polynomial(coordinate[x]).
void add_times_polynomial(const float* row, const float* coordinate,
                          std::span<const float> coefficients, float* sum, std::size_t size);

/// sum[x] += row[x] * sum over p of coefficients[p] modes[p][x]; at least one.
void add_times_modes(const float* row, std::span<const float* const> modes,
                     std::span<const float> coefficients, float* sum, std::size_t size);

/// Every second place of a framed row of 2 * size, weighted 1 3 3 1 over 8 around it.
void halve_row(const float* row, float* result, std::size_t size);

/// A framed row of half the size brought to this one: 3/4 of the nearer place, 1/4 of the next.
/// @param size  even.
void double_row(const float* row, float* result, std::size_t size);

/// sum[x] += weight row[x].
void add_row(const float* row, float weight, float* sum, std::size_t size);

/// sum[x] += sum over p of coordinate[x]^p rows[p][x].
void add_polynomial(std::span<const float* const> rows, const float* coordinate, float* sum,
                    std::size_t size);

/// sum[x] += sum over p of modes[p][x] rows[p][x]; at least as many modes as rows.
void add_products(std::span<const float* const> rows, std::span<const float* const> modes,
                  float* sum, std::size_t size);

}  // namespace lamina::detail
