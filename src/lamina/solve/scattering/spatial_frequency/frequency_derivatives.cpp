// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/frequency_derivatives.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "lamina/solve/scattering/adding_doubling_derivatives/stack_derivatives.h"
#include "lamina/solve/scattering/spatial_frequency/internal/frequency_states.h"
#include "lamina/solve/scattering/spatial_frequency/internal/layer_at_frequency.h"
#include "lamina/solve/scattering/spatial_frequency/internal/leaving_light.h"
#include "lamina/solve/scattering/spatial_frequency/internal/stack_at_frequency.h"

namespace lamina::detail {
namespace {

/// +1 of even azimuthal modes, -1 of odd ones.
LightState signs_of(const FrequencyStates& states) {
  LightState signs(states.size(), -1.0);
  std::fill_n(signs.begin(), states.even, 1.0);
  return signs;
}

/// What a smooth interface sends back of light from below.
Matrix mirror_below(const FrequencySolver& solver, std::size_t index) {
  const GridStack& stack = solver.stack;
  const FrequencyStates states = make_states(solver, stack.ior[index + 1]);
  const Matrix of_nodes = mirror(stack.grid, stack.ior[index + 1], stack.ior[index]);
  Matrix of_states(states.size(), states.size());
  for (std::size_t a = 0; a < states.size(); ++a)
    of_states(a, a) = of_nodes(states.node[a], states.node[a]);
  return of_states;
}

struct DifferentiatedStack {
  std::vector<DifferentiatedLayer> layers;
  StackAtFrequency stack;          ///< crossings bottom first
  std::vector<Matrix> from_below;  ///< [crossing] top first
  std::vector<LightState> signs;   ///< [crossing] top first
};

DifferentiatedStack differentiate_stack(const DifferentiatedSolver& differentiated, double k) {
  const FrequencySolver& solver = differentiated.solver;
  DifferentiatedStack made;
  made.stack.reflection = ground_reflection(solver);
  const auto take = [&](Covered covered) {
    made.stack.crossings.push_back(std::move(covered.crossing));
    made.stack.reflection = std::move(covered.reflection);
  };
  const std::size_t count = solver.stack.layers.size();
  for (std::size_t l = 0; l < count; ++l)
    made.layers.push_back(differentiate_layer_at(differentiated, l, k));
  for (std::size_t l = count; l-- > 0;) {
    take(cover_by_interface(solver, l + 1, std::move(made.stack.reflection)));
    take(cover_by_layer(made.layers[l].operators, std::move(made.stack.reflection)));
  }
  take(cover_by_interface(solver, 0, std::move(made.stack.reflection)));
  for (std::size_t q = 0; q <= count; ++q) {
    made.from_below.push_back(mirror_below(solver, q));
    made.signs.push_back(signs_of(make_states(solver, solver.stack.ior[q + 1])));
    if (q == count) break;
    made.from_below.push_back(made.layers[q].operators.reflection);
    made.signs.push_back(made.signs.back());
  }
  return made;
}

}  // namespace

FrequencyDerivatives response_derivatives(const DifferentiatedSolver& differentiated,
                                          Illumination illumination, double k) {
  const FrequencySolver& solver = differentiated.solver;
  DifferentiatedStack made = differentiate_stack(differentiated, k);
  ArrivingLight arriving = arriving_light(solver, illumination);
  FrequencyDerivatives result{.response = response_to(solver, made.stack, arriving)};
  std::ranges::reverse(made.stack.crossings);
  const CrossedStack crossed{made.stack.crossings, made.from_below, made.signs};
  for (double& of_state : arriving.state) of_state /= arriving.flux;
  const LightFields light = fields_of(crossed, std::move(arriving.state));
  result.reflectance = derivatives_of(
      made.layers, light, gains_above(crossed, weights_of_flux(solver, solver.stack.ior.front())));
  if (solver.stack.is_semi_infinite) {
    result.transmittance.resize(made.layers.size());
    return result;
  }
  LightState below = weights_of_flux(solver, solver.stack.ior.back());
  for (double& weight : below) weight *= 1.0 - solver.stack.ground_reflectance;
  result.transmittance = derivatives_of(made.layers, light, gains_below(crossed, below));
  return result;
}

}  // namespace lamina::detail
