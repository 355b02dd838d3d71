// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "lamina/base/core/small_matrix.h"

namespace lamina {

/// Half a sum of squares, its derivatives, and the lower triangle of the Gauss-Newton matrix of its
/// second ones.
template <std::size_t N>
struct SmallSquares {
  double value = 0.0;
  SmallVector<N> gradient = {};
  SmallMatrix<N> curvature = {};
};

/// Least squares of a few coordinates without memory of its own, for millions of pixels; others
/// have fit_parameters, with errors, starts and notes.
template <std::size_t N>
struct SmallFit {
  std::size_t size = 0;  ///< coordinates that are used
  int most_steps = 30;
  double shortest = 1e-4;        ///< the longest step that counts as none, over `scale`
  SmallVector<N> scale = {};     ///< what 1.5 of is the most of a step
  SmallVector<N> at = {};        ///< the start, then the place that is found
  SmallSquares<N> squares = {};  ///< there

  /// Levenberg and Marquardt's steps [Marquardt1963].
  /// @param objective  squares at a place
  /// @param in_range   of a coordinate and its index, the nearest that it may be
  /// @param is_held    whether a coordinate, of some gradient, is held where it is
  /// @param accept     called where the last objective's place is taken
  template <class Objective, class InRange, class IsHeld, class Accept>
  void run(const Objective& objective, const InRange& in_range, const IsHeld& is_held,
           const Accept& accept) {
    constexpr double longest = 1.5;
    squares = objective(at);
    accept();
    double damping = 1e-3;
    for (int step = 0; step < most_steps && damping <= 1e6; ++step) {
      SmallMatrix<N> damped = squares.curvature;
      for (std::size_t i = 0; i < size; ++i)
        damped[i][i] *= is_held(i, at[i], squares.gradient[i]) ? 1e12 : 1.0 + damping;
      const SmallVector<N> move = solve_cholesky(cholesky(damped, size), size, squares.gradient);
      SmallVector<N> next = at;
      double length = 0.0;
      for (std::size_t i = 0; i < size; ++i) {
        const double most = longest * scale[i];
        next[i] = in_range(i, at[i] - std::clamp(move[i], -most, most));
        length = std::max(length, std::abs(next[i] - at[i]) / scale[i]);
      }
      if (length < shortest) break;
      const SmallSquares<N> there = objective(next);
      if (there.value <= squares.value) {
        at = next;
        squares = there;
        accept();
        damping *= 0.2;
      } else {
        damping = std::max(10.0 * damping, 1e-2);
      }
    }
  }
};

/// The inverse of a curvature: the covariance of the coordinates.
template <std::size_t N>
[[nodiscard]] SmallMatrix<N> small_covariance(const SmallMatrix<N>& curvature, std::size_t size) {
  const SmallMatrix<N> lower = cholesky(curvature, size);
  SmallMatrix<N> inverse = {};
  for (std::size_t i = 0; i < size; ++i) {
    SmallVector<N> unit = {};
    unit[i] = 1.0;
    inverse[i] = solve_cholesky(lower, size, unit);
  }
  return inverse;
}

}  // namespace lamina
