// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/internal/leaving_light.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "lamina/solve/scattering/spatial_frequency/internal/frequency_states.h"

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

/// What a rough top alone throws back of a state that arrives from above, the beams apart.
double thrown_back_by_rough_top(const FrequencySolver& solver, const std::vector<double>& state) {
  if (!solver.top.is_rough) return 0.0;
  const std::size_t active = active_count(solver.stack.grid, solver.stack.ior[0]);
  const std::vector<double> first_mode(state.begin(),
                                       state.begin() + static_cast<std::ptrdiff_t>(active));
  return scattered_flux(solver, product(solver.rough[0][0].reflection_above, first_mode),
                        solver.stack.ior[0]);
}

ArrivingLight normal_beam(const FrequencySolver& solver, std::size_t states) {
  ArrivingLight light{.state = std::vector<double>(states, 0.0)};
  light.state[solver.stack.grid.extra[0]] = 1.0 / std::sqrt(extra_node_etendue);
  return light;
}

/// Equal radiance from all of the hemisphere.
ArrivingLight diffuse_light(const FrequencySolver& solver, std::size_t states) {
  const GridStack& stack = solver.stack;
  const std::size_t outside = active_count(stack.grid, stack.ior[0]);
  const std::size_t inside = active_count(stack.grid, stack.ior[1]);
  ArrivingLight light{.state = std::vector<double>(states, 0.0), .flux = 0.0};
  for (std::size_t i = 0; i < outside; ++i) {  // mode 0 comes first
    if (i == stack.grid.extra[0]) continue;
    const double etendue = stack.grid.etendue[i];
    light.state[i] = std::sqrt(etendue);
    light.flux += etendue;
    if (solver.top.is_rough) continue;
    light.mirrored +=
        etendue * (i < inside ? node_fresnel(stack.grid, i, stack.ior[0], stack.ior[1]) : 1.0);
  }
  return light;
}

}  // namespace

ArrivingLight arriving_light(const FrequencySolver& solver, Illumination illumination) {
  const std::size_t states = make_states(solver, solver.stack.ior.front()).size();
  ArrivingLight light = illumination == Illumination::diffuse ? diffuse_light(solver, states)
                                                              : normal_beam(solver, states);
  light.mirrored += thrown_back_by_rough_top(solver, light.state);
  return light;
}

std::vector<double> weights_of_flux(const FrequencySolver& solver, double ior) {
  std::vector<double> weights(make_states(solver, ior).size(), 0.0);
  for (std::size_t i = 0; i < active_count(solver.stack.grid, ior); ++i)
    if (!is_extra(solver.stack.grid, i)) weights[i] = std::sqrt(solver.stack.grid.etendue[i]);
  return weights;
}

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

FrequencyResponse response_to(const FrequencySolver& solver, const StackAtFrequency& at,
                              const ArrivingLight& arriving) {
  const FrequencyResponse leaving = leaving_flux(solver, at, arriving.state);
  return {.reflectance = (leaving.reflectance - arriving.mirrored) / arriving.flux,
          .transmittance = leaving.transmittance / arriving.flux};
}

}  // namespace lamina::detail
