// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "lamina/acquire/inversion/internal/skin_at_texel.h"

namespace lamina::detail {

/// A symmetric matrix over the numbers of a texel.
using TexelMatrix = std::array<TexelNumbers, most_free_numbers>;

/// The lower triangle L of a = L L^T, for the first n numbers of a positive matrix; what rounding
/// has taken from it counts as a little.
[[nodiscard]] inline TexelMatrix cholesky(TexelMatrix a, std::size_t n) {
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
template <class Lower>
[[nodiscard]] TexelNumbers solve_cholesky(const Lower& lower, std::size_t n, TexelNumbers b) {
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

}  // namespace lamina::detail
