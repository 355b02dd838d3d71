// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/internal/gradient_methods.h"

#include <cmath>
#include <deque>

#include "lamina/skin/acquire/inversion/internal/band_blocks.h"

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

void run_gradient_descent(const PatchObjective& objective, InversionCourse& course) {
  const InversionTables& tables = objective.tables();
  const TexelMaps& weights = objective.weights();
  const std::size_t numbers = tables.numbers.size(), texels = weights[0].size();
  constexpr double difference = 0.01;  // of a number, in its reference value
  constexpr double least_step = 1e-4, growth = 1.3;
  TexelNumbers scale = {};
  for (std::size_t n = 0; n < numbers; ++n)
    scale[n] = fit_value(tables.numbers[n].parameter, tables.reference[n]);
  const auto move = [&](std::vector<float>& map, std::size_t n, const auto& by) {
    const FitParameter& parameter = tables.numbers[n].parameter;
    for (std::size_t t = 0; t < texels; ++t) {
      const double value = fit_value(parameter, static_cast<double>(map[t])) + by(t);
      map[t] = static_cast<float>(
          fit_coordinate(parameter, std::clamp(value, parameter.low, parameter.high)));
    }
  };
  double step = 0.05;
  while (!course.must_end(static_cast<double>(numbers) + 1.0)) {
    const PatchState& at = course.best;
    TexelMaps gradient(numbers, std::vector<float>(texels, 0.0f));
    float largest = 0.0f;
    for (std::size_t n = 0; n < numbers; ++n) {
      TexelMaps other = at.coordinates;
      move(other[n], n, [&](std::size_t) { return difference * scale[n]; });
      const TexelMaps images = objective.light().images(other);
      for (std::size_t i = 0; i < images.size(); ++i)
        for (std::size_t t = 0; t < texels; ++t)
          gradient[n][t] += weights[i][t] * weights[i][t] * (images[i][t] - at.images[i][t]) *
                            (at.images[i][t] - objective.measured()[i][t]);
      for (const float value : gradient[n]) largest = std::max(largest, std::abs(value));
    }
    if (largest == 0.0f) return;
    bool is_better = false;
    for (; step > least_step && !is_better; step *= is_better ? growth : 0.5) {
      if (course.must_end()) return;
      TexelMaps next = at.coordinates;
      for (std::size_t n = 0; n < numbers; ++n)
        move(next[n], n, [&](std::size_t t) {
          return -step * scale[n] * static_cast<double>(gradient[n][t] / largest);
        });
      PatchState state = objective.state(std::move(next));
      is_better = state.objective < at.objective;
      // It gains little in many steps: no step is too small to go on.
      if (is_better) course.take(std::move(state));
    }
    if (!is_better || course.stop == InversionStop::interrupted) return;
  }
}

}  // namespace lamina::detail
