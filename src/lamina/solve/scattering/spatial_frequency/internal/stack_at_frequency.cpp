// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/internal/stack_at_frequency.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "lamina/solve/scattering/spatial_frequency/internal/frequency_states.h"
#include "lamina/solve/scattering/spatial_frequency/internal/layer_at_frequency.h"

namespace lamina::detail {
namespace {

/// A rough boundary between states: each mode for itself.
Matrix of_all_modes(const FrequencySolver& solver, std::size_t index, Matrix RoughBoundary::*member,
                    const FrequencyStates& to, const FrequencyStates& from) {
  Matrix all(to.size(), from.size());
  for (std::size_t b = 0; b < from.size(); ++b) {
    const Matrix& of_mode = solver.rough[static_cast<std::size_t>(from.mode[b])][index].*member;
    for (std::size_t a = 0; a < to.size(); ++a)
      if (to.mode[a] == from.mode[b]) all(a, b) = of_mode(to.node[a], from.node[b]);
  }
  return all;
}

Covered cover_by_rough_interface(const FrequencySolver& solver, std::size_t index, Matrix below) {
  const FrequencyStates before = make_states(solver, solver.stack.ior[index]);
  const FrequencyStates behind = make_states(solver, solver.stack.ior[index + 1]);
  const auto of = [&](Matrix RoughBoundary::*member, const FrequencyStates& to,
                      const FrequencyStates& from) {
    return of_all_modes(solver, index, member, to, from);
  };
  const Matrix returns = between(of(&RoughBoundary::reflection_below, behind, behind), below);
  Matrix pass = product(returns, of(&RoughBoundary::transmission_down, behind, before));
  Matrix reflection =
      product(of(&RoughBoundary::transmission_up, before, behind), product(below, pass));
  const Matrix first = of(&RoughBoundary::reflection_above, before, before);
  for (std::size_t k = 0; k < reflection.values.size(); ++k)
    reflection.values[k] += first.values[k];
  return {{std::move(pass), std::move(below)}, std::move(reflection)};
}

/// An interface between equal indices.
Covered cover_by_nothing(Matrix below) {
  Matrix all(below.rows, below.rows);
  for (std::size_t a = 0; a < below.rows; ++a) all(a, a) = 1.0;
  Matrix reflection = below;
  return {{all, std::move(below), all}, std::move(reflection)};
}

}  // namespace

Covered cover_by_interface(const FrequencySolver& solver, std::size_t index, Matrix below) {
  const GridStack& stack = solver.stack;
  if (is_rough(stack.interfaces[index], stack.ior[index], stack.ior[index + 1]))
    return cover_by_rough_interface(solver, index, std::move(below));
  const double ior_before = stack.ior[index], ior_behind = stack.ior[index + 1];
  if (ior_before == ior_behind) return cover_by_nothing(std::move(below));
  const FrequencyStates before = make_states(solver, ior_before),
                        behind = make_states(solver, ior_behind);
  const std::size_t active_before = active_count(stack.grid, ior_before),
                    active_behind = active_count(stack.grid, ior_behind);
  const std::size_t common = std::min(active_before, active_behind);
  std::vector<double> reflectance(std::max(active_before, active_behind), 1.0);  // [node]
  for (std::size_t i = 0; i < common; ++i)
    reflectance[i] = node_fresnel(stack.grid, i, ior_before, ior_behind);
  Matrix mirror(behind.size(), behind.size());
  for (std::size_t a = 0; a < behind.size(); ++a) mirror(a, a) = reflectance[behind.node[a]];
  Matrix returns = between(mirror, below);
  const Matrix sent_back = product(below, returns);
  Covered covered{{Matrix(behind.size(), before.size()), std::move(below)},
                  Matrix(before.size(), before.size())};
  for (std::size_t b = 0; b < before.size(); ++b) {
    const double r_b = reflectance[before.node[b]];
    covered.reflection(b, b) += r_b;
    if (before.node[b] >= common) continue;
    const std::size_t from = place(behind, before.mode[b], before.node[b]);
    for (std::size_t a = 0; a < behind.size(); ++a)
      covered.crossing.pass(a, b) = returns(a, from) * (1.0 - r_b);
    for (std::size_t a = 0; a < before.size(); ++a) {
      if (before.node[a] >= common) continue;
      const std::size_t to = place(behind, before.mode[a], before.node[a]);
      covered.reflection(a, b) +=
          (1.0 - reflectance[before.node[a]]) * sent_back(to, from) * (1.0 - r_b);
    }
  }
  covered.crossing.returns = std::move(returns);
  return covered;
}

Matrix ground_reflection(const FrequencySolver& solver) {
  const GridStack& stack = solver.stack;
  const std::size_t active = active_count(stack.grid, stack.ior.back());
  const std::size_t n = make_states(solver, stack.ior.back()).size();
  Matrix ground(n, n);
  if (stack.ground_reflectance == 0.0) return ground;
  const auto& etendue = stack.grid.etendue;
  const double all =
      std::accumulate(etendue.begin(), etendue.begin() + static_cast<std::ptrdiff_t>(active), 0.0);
  for (std::size_t j = 0; j < active; ++j)  // mode 0 comes first
    for (std::size_t i = 0; i < active; ++i)
      ground(i, j) = stack.ground_reflectance * std::sqrt(etendue[i] * etendue[j]) / all;
  return ground;
}

std::vector<StackAtFrequency> stacks_at(const FrequencySolver& solver,
                                        std::span<const double> frequencies) {
  std::vector<StackAtFrequency> stacks(frequencies.size(), {{}, ground_reflection(solver)});
  const auto take = [](StackAtFrequency& stack, Covered covered) {
    stack.crossings.push_back(std::move(covered.crossing));
    stack.reflection = std::move(covered.reflection);
  };
  for (std::size_t index = solver.stack.layers.size(); index-- > 0;) {
    const auto operators = layer_at_frequencies(solver, index, frequencies);
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
      take(stacks[i], cover_by_interface(solver, index + 1, std::move(stacks[i].reflection)));
      take(stacks[i], cover_by_layer(operators[i], std::move(stacks[i].reflection)));
    }
  }
  for (StackAtFrequency& stack : stacks)
    take(stack, cover_by_interface(solver, 0, std::move(stack.reflection)));
  return stacks;
}

}  // namespace lamina::detail
