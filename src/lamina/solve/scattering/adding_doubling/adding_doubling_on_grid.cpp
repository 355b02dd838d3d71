// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/adding_doubling_on_grid.h"

#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina::detail {
namespace {

/// Flux of a state vector, whose entries are flux over the square root of etendue.
double flux(const GridStack& stack, const std::vector<double>& state) {
  double sum = 0.0;
  for (std::size_t i = 0; i < state.size(); ++i) sum += std::sqrt(stack.grid.etendue[i]) * state[i];
  return sum;
}

}  // namespace

void require_incidence(const Incidence& incidence) {
  if (!incidence.is_diffuse &&
      !(0.0 <= incidence.theta && incidence.theta < 0.5 * std::numbers::pi))
    throw InvalidInput("angle of incidence: must lie in [0, pi/2), but is " +
                       number_text(incidence.theta));
}

std::vector<GridDirection> beams_of(const LayerStack& stack,
                                    std::span<const Incidence> incidences) {
  std::vector<GridDirection> beams;
  for (const Incidence& incidence : incidences)
    if (!incidence.is_diffuse) beams.push_back(direction_in(stack.ior_above(), incidence.theta));
  return beams;
}

std::vector<double> incident_state(const GridStack& stack, std::optional<std::size_t> beam_number) {
  std::vector<double> state(active_count(stack.grid, stack.ior.front()), 0.0);
  if (beam_number) {
    const std::size_t beam = stack.grid.extra[*beam_number];
    state[beam] = 1.0 / std::sqrt(stack.grid.etendue[beam]);
    return state;
  }
  double all = 0.0;
  for (std::size_t i = 0; i < state.size(); ++i) all += stack.grid.etendue[i];
  for (std::size_t i = 0; i < state.size(); ++i) state[i] = std::sqrt(stack.grid.etendue[i]) / all;
  return state;
}

AddingDoublingTotals totals_of(const GridStack& on_grid, const StackOperators& operators,
                               std::vector<double> down) {
  AddingDoublingTotals result;
  SlabTotals& totals = result.totals;
  totals.specular_reflectance = flux(on_grid, product(operators.first_reflection, down));
  totals.diffuse_reflectance =
      flux(on_grid, product(operators.reflection, down)) - totals.specular_reflectance;
  for (std::size_t i = 0; i < down.size(); ++i) {
    if (down[i] == 0.0) continue;
    const double arriving = std::sqrt(on_grid.grid.etendue[i]) * down[i];
    const auto unscattered = unscattered_flux(on_grid, i, Unscattered::by_medium);
    result.unscattered_reflectance += arriving * unscattered.reflectance;
    result.unscattered_transmittance += arriving * unscattered.down.back();
  }

  // Down through the stack: net flux behind each crossing; a layer keeps the difference.
  double net_before = 0.0;
  for (std::size_t c = 0; c < operators.crossings.size(); ++c) {
    const Crossing& crossing = operators.crossings[c];
    down = product(crossing.pass, down);
    const double net =
        flux(on_grid, down) - flux(on_grid, product(crossing.reflection_below, down));
    const bool is_layer = c % 2 == 1;
    if (is_layer) totals.absorptance.push_back(net_before - net);
    net_before = net;
  }
  totals.transmittance = net_before;
  return result;
}

}  // namespace lamina::detail
