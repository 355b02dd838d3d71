// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

// Symmetric systems of a few unknowns, for work that is done at every pixel; dense_matrix.h has
// larger ones.

namespace lamina {

template <std::size_t N>
using SmallVector = std::array<double, N>;
template <std::size_t N>
using SmallMatrix = std::array<SmallVector<N>, N>;  ///< [row][column]

/// The lower triangle L of a = L L^T, for the first n <= N unknowns of a positive matrix, of which
/// the lower triangle is read; what rounding has taken from it counts as a little.
template <std::size_t N>
[[nodiscard]] SmallMatrix<N> cholesky(SmallMatrix<N> a, std::size_t n) {
  for (std::size_t j = 0; j < n; ++j) {
    const double little = std::max(1e-12 * a[j][j], 1e-30);
    for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
    a[j][j] = std::sqrt(std::max(a[j][j], little));
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      a[i][j] /= a[j][j];
    }
  }
  return a;
}

/// x of L L^T x = b.
/// @param lower  L as cholesky gives it, or kept in other numbers: lower[row][column]
template <class Lower, std::size_t N>
[[nodiscard]] SmallVector<N> solve_cholesky(const Lower& lower, std::size_t n, SmallVector<N> b) {
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= lower[i][k] * b[k];
    b[i] /= lower[i][i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= lower[k][i] * b[k];
    b[i] /= lower[i][i];
  }
  return b;
}

}  // namespace lamina
