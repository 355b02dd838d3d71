// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "lamina/skin/acquire/inversion/steps/band_blocks.h"
#include "lamina/skin/acquire/inversion/steps/inversion_course.h"

namespace lamina::detail {

/// x of matrix x = b by conjugate gradients, from 0.
///
/// @param tolerance   of the residual, in the norm of the preconditioner, relative to that of b
/// @param must_end    asked before each step
template <class MustEnd>
[[nodiscard]] TexelMaps solve_by_conjugate_gradients(const PatchObjective& objective,
                                                     const BandBlocks& blocks, TexelMaps b,
                                                     int most_steps, double tolerance,
                                                     const MustEnd& must_end) {
  TexelMaps x = b;
  for (std::vector<float>& map : x) std::ranges::fill(map, 0.0f);
  TexelMaps direction = blocks.solve(b);
  double square = dot(b, direction);
  const double enough = square * tolerance * tolerance;
  for (int step = 0; step < most_steps && square > enough && !must_end(); ++step) {
    const TexelMaps product = objective.times_matrix(direction);
    const double length = square / dot(direction, product);
    add_times(x, length, direction);
    add_times(b, -length, product);
    const TexelMaps preconditioned = blocks.solve(b);
    const double next = dot(b, preconditioned);
    scale_and_add(direction, next / square, preconditioned);
    square = next;
  }
  return x;
}

/// Gauss-Newton steps from the best state of a course on.
void run_gauss_newton(PatchObjective& objective, const TexelMaps& level, InversionCourse& course,
                      int most_steps = std::numeric_limits<int>::max());

}  // namespace lamina::detail
