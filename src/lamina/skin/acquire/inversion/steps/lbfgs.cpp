// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/steps/lbfgs.h"

#include <deque>

#include "lamina/skin/acquire/inversion/steps/band_blocks.h"

namespace lamina::detail {
namespace {

/// A step, and the change of the gradient along it.
struct Pair {
  TexelMaps step, change;
  double product;
};

/// The gradient times about the inverse of the matrix of second derivatives, by two loops.
TexelMaps newton_direction(TexelMaps gradient, const std::deque<Pair>& pairs,
                           const BandBlocks& blocks) {
  std::vector<double> parts(pairs.size());
  for (std::size_t i = pairs.size(); i-- > 0;) {
    parts[i] = dot(pairs[i].step, gradient) / pairs[i].product;
    add_times(gradient, -parts[i], pairs[i].change);
  }
  TexelMaps direction = blocks.solve(gradient);
  for (std::size_t i = 0; i < pairs.size(); ++i)
    add_times(direction, parts[i] - dot(pairs[i].change, direction) / pairs[i].product,
              pairs[i].step);
  return direction;
}

}  // namespace

void run_lbfgs(PatchObjective& objective, const TexelMaps& level, InversionCourse& course,
               int most_steps) {
  constexpr std::size_t most_pairs = 12;
  constexpr double enough = 1e-4;  // of the decrease that the slope promises [Armijo1966]
  if (course.must_end(3.0)) return;
  objective.linearize(course.best);
  const BandBlocks blocks(objective, course.best.coordinates, level);
  TexelMaps gradient = objective.gradient(course.best);
  std::deque<Pair> pairs;
  for (int taken = 0; taken < most_steps && !course.must_end(2.0); ++taken) {
    const TexelMaps direction = newton_direction(gradient, pairs, blocks);
    const double slope = dot(gradient, direction);
    const TexelMaps before = course.best.coordinates;
    bool is_better = false, ends = false;
    for (double factor = 1.0; factor > 0.01 && !is_better; factor *= 0.4) {
      if (course.must_end()) return;
      PatchState next = objective.state(moved(objective.tables(), before, -factor, direction));
      is_better = next.objective < course.best.objective - enough * factor * slope;
      if (is_better) ends = course.take(std::move(next));
    }
    if (!is_better) course.ends(InversionStop::converged);
    if (!is_better || ends) return;
    TexelMaps next_gradient = objective.gradient(course.best);
    Pair pair{course.best.coordinates, next_gradient, 0.0};
    add_times(pair.step, -1.0, before);
    add_times(pair.change, -1.0, gradient);
    pair.product = dot(pair.step, pair.change);
    gradient = std::move(next_gradient);
    if (pair.product <= 0.0) continue;
    pairs.push_back(std::move(pair));
    if (pairs.size() > most_pairs) pairs.pop_front();
  }
}

}  // namespace lamina::detail
