// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"

#include <cmath>
#include <utility>

#include "lamina/solve/scattering/spatial_frequency/internal/frequency_states.h"
#include "lamina/solve/scattering/spatial_frequency/internal/leaving_light.h"
#include "lamina/solve/scattering/spatial_frequency/internal/stack_at_frequency.h"

namespace lamina::detail {
namespace {

std::vector<FrequencyResponse> responses_to(const FrequencySolver& solver,
                                            Illumination illumination,
                                            std::span<const double> frequencies) {
  const ArrivingLight arriving = arriving_light(solver, illumination);
  std::vector<FrequencyResponse> result;
  for (const StackAtFrequency& at : stacks_at(solver, frequencies))
    result.push_back(response_to(solver, at, arriving));
  return result;
}

}  // namespace

std::vector<FrequencyResponse> responses(const FrequencySolver& solver,
                                         std::span<const double> frequencies) {
  return responses_to(solver, Illumination::normal_beam, frequencies);
}

FrequencyResponse response(const FrequencySolver& solver, double k) {
  return responses(solver, {&k, 1}).front();
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

std::vector<FrequencyResponse> diffuse_responses(const FrequencySolver& solver,
                                                 std::span<const double> frequencies) {
  return responses_to(solver, Illumination::diffuse, frequencies);
}

}  // namespace lamina::detail
