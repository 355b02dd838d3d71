// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/spatial_frequency/frequency_response.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lamina/scattering/spatial_frequency/internal/frequency_states.h"
#include "lamina/scattering/spatial_frequency/internal/stack_at_frequency.h"

namespace lamina::detail {
namespace {

bool is_extra(const DirectionGrid& grid, std::size_t node) {
  return std::ranges::find(grid.extra, node) != grid.extra.end();
}

/// Flux of mode 0 in all directions but the beams'.
double scattered_flux(const FrequencySolver& solver, const std::vector<double>& state, double ior) {
  double sum = 0.0;
  for (std::size_t i = 0; i < active_count(solver.stack.grid, ior); ++i)
    if (!is_extra(solver.stack.grid, i)) sum += std::sqrt(solver.stack.grid.etendue[i]) * state[i];
  return sum;
}

StackAtFrequency stack_at_frequency(const FrequencySolver& solver, double k) {
  return stacks_at(solver, {&k, 1}).front();
}

/// What a rough top alone throws back of a state that arrives from above, the beams apart.
double thrown_back_by_rough_top(const FrequencySolver& solver, const std::vector<double>& state) {
  if (!solver.top.is_rough) return 0.0;
  const std::size_t active = active_count(solver.stack.grid, solver.stack.ior[0]);
  const std::vector<double> first_mode(state.begin(),
                                       state.begin() + static_cast<std::ptrdiff_t>(active));
  return scattered_flux(solver, product(solver.rough[0][0].reflection_above, first_mode),
                        solver.stack.ior[0]);
}

/// What leaves the stack in mode 0, the beam apart, for a state that arrives from above.
FrequencyResponse leaving_flux(const FrequencySolver& solver, const StackAtFrequency& at,
                               std::vector<double> state) {
  FrequencyResponse result;
  result.reflectance =
      scattered_flux(solver, product(at.reflection, state), solver.stack.ior.front());
  if (solver.stack.is_semi_infinite) return result;
  for (std::size_t c = at.crossings.size(); c-- > 0;) state = product(at.crossings[c].pass, state);
  result.transmittance = (1.0 - solver.stack.ground_reflectance) *
                         scattered_flux(solver, state, solver.stack.ior.back());
  return result;
}

}  // namespace

std::vector<FrequencyResponse> responses(const FrequencySolver& solver,
                                         std::span<const double> frequencies) {
  std::vector<FrequencyResponse> result;
  for (const StackAtFrequency& at : stacks_at(solver, frequencies)) {
    std::vector<double> state(at.reflection.rows, 0.0);
    state[solver.stack.grid.extra[0]] = 1.0 / std::sqrt(extra_node_etendue);
    const double mirrored = thrown_back_by_rough_top(solver, state);
    result.push_back(leaving_flux(solver, at, std::move(state)));
    result.back().reflectance -= mirrored;
  }
  return result;
}

FrequencyResponse response(const FrequencySolver& solver, double k) {
  return responses(solver, {&k, 1}).front();
}

SpectralReflection spectral_reflection(const FrequencySolver& solver, double k) {
  FrequencyStates states = make_states(solver, solver.stack.ior.front());
  return {stack_at_frequency(solver, k).reflection, std::move(states.mode), std::move(states.node)};
}

std::vector<std::vector<FrequencyResponse>> oblique_responses(const FrequencySolver& solver,
                                                              std::span<const double> frequencies) {
  const FrequencyStates outside = make_states(solver, solver.stack.ior.front());
  std::vector<std::vector<FrequencyResponse>> result;
  for (const StackAtFrequency& at : stacks_at(solver, frequencies)) {
    std::vector<FrequencyResponse>& modes = result.emplace_back();
    for (int m = 0; m <= solver.modes; ++m) {
      std::vector<double> state(at.reflection.rows, 0.0);
      state[place(outside, m, solver.stack.grid.extra[1])] = 1.0 / std::sqrt(extra_node_etendue);
      modes.push_back(leaving_flux(solver, at, std::move(state)));
    }
  }
  return result;
}

std::vector<FrequencyResponse> oblique_response(const FrequencySolver& solver, double k) {
  return oblique_responses(solver, {&k, 1}).front();
}

std::vector<FrequencyResponse> diffuse_responses(const FrequencySolver& solver,
                                                 std::span<const double> frequencies) {
  const GridStack& stack = solver.stack;
  const std::size_t outside = active_count(stack.grid, stack.ior[0]);
  const std::size_t inside = active_count(stack.grid, stack.ior[1]);
  std::vector<FrequencyResponse> result;
  for (const StackAtFrequency& at : stacks_at(solver, frequencies)) {
    std::vector<double> state(at.reflection.rows, 0.0);
    double arriving = 0.0, mirrored = 0.0;
    for (std::size_t i = 0; i < outside; ++i) {  // mode 0 comes first
      if (i == stack.grid.extra[0]) continue;
      const double etendue = stack.grid.etendue[i];
      state[i] = std::sqrt(etendue);
      arriving += etendue;
      if (solver.top.is_rough) continue;
      mirrored +=
          etendue * (i < inside ? node_fresnel(stack.grid, i, stack.ior[0], stack.ior[1]) : 1.0);
    }
    mirrored += thrown_back_by_rough_top(solver, state);
    const FrequencyResponse leaving = leaving_flux(solver, at, std::move(state));
    result.push_back({.reflectance = (leaving.reflectance - mirrored) / arriving,
                      .transmittance = leaving.transmittance / arriving});
  }
  return result;
}

FrequencyResponse diffuse_response(const FrequencySolver& solver, double k) {
  return diffuse_responses(solver, {&k, 1}).front();
}

}  // namespace lamina::detail
