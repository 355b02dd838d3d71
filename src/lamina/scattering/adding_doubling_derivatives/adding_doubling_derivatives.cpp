// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/adding_doubling_derivatives/adding_doubling_derivatives.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "lamina/core/error.h"
#include "lamina/core/progress.h"
#include "lamina/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/scattering/adding_doubling_derivatives/internal/differentiated_layer.h"

namespace lamina {
namespace {

using detail::GridStack;
using detail::StackOperators;
using State = std::vector<double>;  ///< flux over the square root of etendue, [node]

double dot(const State& a, const State& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

State transposed_product(const detail::Matrix& m, const State& x) {
  State y(m.columns, 0.0);
  for (std::size_t j = 0; j < m.columns; ++j)
    for (std::size_t i = 0; i < m.rows; ++i) y[j] += m(i, j) * x[i];
  return y;
}

void add(State& to, const State& what) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += what[i];
}

/// Square roots of etendue: what a state weighs as flux, and in states diffuse light.
State flux_weights(const GridStack& stack, double ior) {
  State weights(active_count(stack.grid, ior));
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = std::sqrt(stack.grid.etendue[i]);
  return weights;
}

/// Light behind each crossing: going down and up; or what a total gains by light that starts there.
struct Fields {
  std::vector<State> down, up;  ///< [crossing]
};

Fields fields_of(const StackOperators& operators, State down) {
  Fields fields;
  for (const detail::Crossing& crossing : operators.crossings) {
    down = detail::product(crossing.pass, down);
    fields.down.push_back(down);
    fields.up.push_back(detail::product(crossing.reflection_below, down));
  }
  return fields;
}

/// What light that starts behind a crossing adds to the diffuse reflectance. By reciprocity the
/// light that diffuse illumination from above brings there the other way.
Fields gains_of_reflectance(const GridStack& stack, const StackOperators& operators) {
  Fields light = fields_of(operators, flux_weights(stack, stack.ior.front()));
  return {.down = std::move(light.up), .up = std::move(light.down)};
}

/// The same for the transmittance: from the bottom up for light that goes down and meets nothing
/// above, then from the top down for light that starts upward.
Fields gains_of_transmittance(const GridStack& stack, const StackOperators& operators,
                              std::span<const detail::DifferentiatedLayer> layers) {
  const std::size_t count = operators.crossings.size();
  Fields gains{std::vector<State>(count), std::vector<State>(count)};
  State straight = flux_weights(stack, stack.ior.back());
  for (double& weight : straight) weight *= 1.0 - stack.ground_reflectance;
  for (std::size_t c = count; c-- > 0;) {
    gains.down[c] = straight;
    straight = transposed_product(operators.crossings[c].pass, straight);
  }
  State upward(active_count(stack.grid, stack.ior.front()), 0.0);
  for (std::size_t c = 0; c < count; ++c) {
    const detail::Crossing& crossing = operators.crossings[c];
    const std::size_t k = c / 2;
    upward = detail::product(crossing.pass, upward);
    const State returned = transposed_product(crossing.returns, gains.down[c]);
    add(upward,
        detail::product(c % 2 == 1 ? layers[k].operators.reflection
                                   : detail::mirror(stack.grid, stack.ior[k + 1], stack.ior[k]),
                        returned));
    gains.up[c] = upward;
    add(gains.down[c], detail::product(crossing.reflection_below, upward));
  }
  return gains;
}

/// Of a total, by the change of layer k: light that arrives at the layer, and what that which
/// leaves it is worth.
double derivative(const detail::LayerOperators& change, const Fields& light, const Fields& gains,
                  std::size_t k) {
  const State& from_above = light.down[2 * k];
  const State& from_below = light.up[2 * k + 1];
  const State& to_above = gains.up[2 * k];
  const State& to_below = gains.down[2 * k + 1];
  const auto at = [](const State& left, const detail::Matrix& m, const State& right) {
    return dot(left, detail::product(m, right));
  };
  return at(to_above, change.reflection, from_above) +
         at(to_above, change.transmission, from_below) +
         at(to_below, change.transmission, from_above) +
         at(to_below, change.reflection, from_below);
}

std::vector<LayerDerivatives> derivatives_of(std::span<const detail::DifferentiatedLayer> layers,
                                             const Fields& light, const Fields& gains) {
  std::vector<LayerDerivatives> derivatives;
  for (std::size_t k = 0; k < layers.size(); ++k)
    derivatives.push_back({.by_sigma_a = derivative(layers[k].by_sigma_a, light, gains, k),
                           .by_sigma_s = derivative(layers[k].by_sigma_s, light, gains, k),
                           .by_g = derivative(layers[k].by_g, light, gains, k),
                           .by_thickness = derivative(layers[k].by_thickness, light, gains, k)});
  return derivatives;
}

/// Light of one node that is never scattered: the same with numbers for matrices. What light of the
/// node is worth at the bottom is what light from below brings, the stack turned over.
void add_unscattered(const GridStack& stack, std::size_t node, double arriving,
                     std::vector<LayerDerivatives>& derivatives) {
  const std::size_t count = stack.layers.size();
  const auto light = detail::unscattered_flux(stack, node, detail::Unscattered::by_medium);
  if (light.down.back() == 0.0) return;
  const auto gains =
      detail::unscattered_flux(turned_over(stack), node, detail::Unscattered::by_medium);
  for (std::size_t k = 0; k < count; ++k) {
    const detail::GridLayer& layer = stack.layers[k];
    if (!std::isfinite(layer.thickness)) continue;
    const std::size_t turned = count - 1 - k;
    const double per_length =
        -arriving *
        (gains.up[2 * turned + 1] * light.up[2 * k + 1] +
         gains.down[2 * turned] * light.down[2 * k]) /
        cosine(stack.grid, node, layer.ior) *
        std::exp(-layer.extinction * layer.thickness / cosine(stack.grid, node, layer.ior));
    derivatives[k].by_sigma_a += layer.thickness * per_length;
    derivatives[k].by_sigma_s += layer.thickness * per_length;
    derivatives[k].by_thickness += layer.extinction * per_length;
  }
}

void check_differentiable(const LayerStack& stack) {
  detail::require_smooth(stack, "adding-doubling with derivatives");
  if (is_semi_infinite(stack) && stack.layers().back().medium.sigma_a == 0.0)
    throw InvalidInput("layer " + std::to_string(stack.layers().size() - 1) +
                       ": an infinitely thick layer that absorbs nothing has no derivative by "
                       "sigma_a; make it finite or absorbing");
}

/// Unit flux from above.
State incident_light(const GridStack& stack, std::optional<std::size_t> beam_number) {
  State state = flux_weights(stack, stack.ior.front());
  const double all = dot(state, state);
  if (!beam_number) {
    for (double& of_node : state) of_node /= all;
    return state;
  }
  const std::size_t beam = stack.grid.extra[*beam_number];
  const double of_beam = 1.0 / state[beam];
  std::fill(state.begin(), state.end(), 0.0);
  state[beam] = of_beam;
  return state;
}

}  // namespace

std::vector<AddingDoublingDerivatives> adding_doubling_derivatives_by_angle(
    const LayerStack& stack, std::span<const Incidence> incidences,
    const AddingDoublingOptions& options) {
  check_differentiable(stack);
  const std::vector<AddingDoublingTotals> totals =
      adding_doubling_by_angle(stack, incidences, options);
  if (totals.empty()) return {};
  std::vector<GridDirection> beams;
  for (const Incidence& incidence : incidences)
    if (!incidence.is_diffuse) beams.push_back(direction_in(stack.ior_above(), incidence.theta));

  const GridStack on_grid = detail::make_grid_stack(stack, totals.front().nodes, beams);
  std::vector<detail::DifferentiatedLayer> layers;
  std::vector<detail::LayerOperators> layer_operators;
  for (std::size_t k = 0; k < on_grid.layers.size(); ++k) {
    layers.push_back(
        detail::differentiate_layer(stack.layers()[k], on_grid.layers[k], on_grid.grid));
    layer_operators.push_back(layers.back().operators);
    report_or_throw(of_unknown_length(options.progress), 0.0);
  }
  const StackOperators operators = detail::stack_operators(
      on_grid, 0, detail::RoughBoundaries(on_grid.interfaces.size()), layer_operators);
  const Fields of_reflectance = gains_of_reflectance(on_grid, operators);
  const Fields of_transmittance = gains_of_transmittance(on_grid, operators, layers);

  std::vector<AddingDoublingDerivatives> results;
  std::size_t beam = 0;
  for (std::size_t i = 0; i < incidences.size(); ++i) {
    const State down = incidences[i].is_diffuse ? incident_light(on_grid, std::nullopt)
                                                : incident_light(on_grid, beam++);
    const Fields light = fields_of(operators, down);
    AddingDoublingDerivatives result{
        .totals = totals[i],
        .diffuse_reflectance = derivatives_of(layers, light, of_reflectance),
        .transmittance = derivatives_of(layers, light, of_transmittance),
        .unscattered_transmittance = std::vector<LayerDerivatives>(layers.size())};
    for (std::size_t node = 0; node < down.size(); ++node)
      if (down[node] != 0.0)
        add_unscattered(on_grid, node, std::sqrt(on_grid.grid.etendue[node]) * down[node],
                        result.unscattered_transmittance);
    results.push_back(std::move(result));
  }
  return results;
}

AddingDoublingDerivatives adding_doubling_derivatives(const LayerStack& stack, Incidence incidence,
                                                      const AddingDoublingOptions& options) {
  return adding_doubling_derivatives_by_angle(stack, {&incidence, 1}, options).front();
}

}  // namespace lamina
