// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling_derivatives/adding_doubling_derivatives.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/progress.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_on_grid.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/differentiated_layer.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/stack_derivatives.h"

namespace lamina {
namespace {

using detail::GridStack;
using detail::LightState;
using detail::StackOperators;

/// Square roots of etendue: what a state weighs as flux, and in states diffuse light.
LightState flux_weights(const GridStack& stack, double ior) {
  LightState weights(active_count(stack.grid, ior));
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = std::sqrt(stack.grid.etendue[i]);
  return weights;
}

/// [crossing] What a layer or interface sends back of light from below.
std::vector<detail::Matrix> reflections_from_below(
    const GridStack& stack, std::span<const detail::DifferentiatedLayer> layers) {
  std::vector<detail::Matrix> reflections{detail::mirror(stack.grid, stack.ior[1], stack.ior[0])};
  for (std::size_t k = 0; k < layers.size(); ++k) {
    reflections.push_back(layers[k].operators.reflection);
    reflections.push_back(detail::mirror(stack.grid, stack.ior[k + 2], stack.ior[k + 1]));
  }
  return reflections;
}

/// Light of one node that is never scattered: the same with numbers for matrices. What light of the
/// node is worth at the bottom is what light from below brings, the stack turned over; above, what
/// light from above brings the other way.
void add_unscattered(const GridStack& stack, std::size_t node, double arriving,
                     AddingDoublingDerivatives& result) {
  const std::size_t count = stack.layers.size();
  const auto light = detail::unscattered_flux(stack, node, detail::Unscattered::by_medium);
  const bool is_open = light.down.back() != 0.0;
  const auto gains =
      is_open ? detail::unscattered_flux(turned_over(stack), node, detail::Unscattered::by_medium)
              : detail::UnscatteredFlux{};
  for (std::size_t k = 0; k < count; ++k) {
    const detail::GridLayer& layer = stack.layers[k];
    if (!std::isfinite(layer.thickness) || node >= active_count(stack.grid, layer.ior)) continue;
    const double cos = cosine(stack.grid, node, layer.ior);
    const double per_length = -arriving / cos * std::exp(-layer.extinction * layer.thickness / cos);
    const auto add = [&](double gain, LayerDerivatives& derivatives) {
      derivatives.by_sigma_a += layer.thickness * per_length * gain;
      derivatives.by_sigma_s += layer.thickness * per_length * gain;
      derivatives.by_thickness += layer.extinction * per_length * gain;
    };
    const double down = light.down[2 * k], up = light.up[2 * k + 1];
    add(2.0 * down * up, result.unscattered_reflectance[k]);
    if (!is_open) continue;
    const std::size_t turned = count - 1 - k;
    add(gains.up[2 * turned + 1] * up + gains.down[2 * turned] * down,
        result.unscattered_transmittance[k]);
  }
}

void check_differentiable(const LayerStack& stack) {
  detail::require_smooth(stack, "adding-doubling with derivatives");
  if (is_semi_infinite(stack) && stack.layers().back().medium.sigma_a == 0.0)
    throw InvalidInput("layer " + std::to_string(stack.layers().size() - 1) +
                       ": an infinitely thick layer that absorbs nothing has no derivative by "
                       "sigma_a; make it finite or absorbing");
}

/// On one grid, [incidence].
std::vector<AddingDoublingDerivatives> derivatives_on_grid(const LayerStack& stack,
                                                           std::span<const Incidence> incidences,
                                                           int nodes, const Progress& progress) {
  const GridStack on_grid =
      detail::make_grid_stack(stack, nodes, detail::beams_of(stack, incidences));
  std::vector<detail::DifferentiatedLayer> layers;
  std::vector<detail::LayerOperators> layer_operators;
  for (std::size_t k = 0; k < on_grid.layers.size(); ++k) {
    layers.push_back(
        detail::differentiate_layer(stack.layers()[k], on_grid.layers[k], on_grid.grid));
    layer_operators.push_back(layers.back().operators);
    report_or_throw(progress, 0.0);
  }
  const StackOperators operators = detail::stack_operators(
      on_grid, 0, detail::RoughBoundaries(on_grid.interfaces.size()), layer_operators);
  const std::vector<detail::Matrix> from_below = reflections_from_below(on_grid, layers);
  const detail::CrossedStack crossed{operators.crossings, from_below};
  const auto of_reflectance = gains_above(crossed, flux_weights(on_grid, on_grid.ior.front()));
  LightState below = flux_weights(on_grid, on_grid.ior.back());
  for (double& weight : below) weight *= 1.0 - on_grid.ground_reflectance;
  const auto of_transmittance = gains_below(crossed, below);

  std::vector<AddingDoublingDerivatives> results;
  std::size_t beam = 0;
  for (const Incidence& incidence : incidences) {
    const LightState down = incidence.is_diffuse ? detail::incident_state(on_grid, std::nullopt)
                                                 : detail::incident_state(on_grid, beam++);
    const auto light = fields_of(crossed, down);
    AddingDoublingDerivatives result{
        .totals = detail::totals_of(on_grid, operators, down),
        .diffuse_reflectance = derivatives_of(layers, light, of_reflectance),
        .transmittance = derivatives_of(layers, light, of_transmittance),
        .unscattered_transmittance = std::vector<LayerDerivatives>(layers.size()),
        .unscattered_reflectance = std::vector<LayerDerivatives>(layers.size())};
    result.totals.nodes = nodes;
    result.totals.estimated_error = 1.0;
    for (std::size_t node = 0; node < down.size(); ++node)
      if (down[node] != 0.0)
        add_unscattered(on_grid, node, std::sqrt(on_grid.grid.etendue[node]) * down[node], result);
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace

std::vector<AddingDoublingDerivatives> adding_doubling_derivatives_by_angle(
    const LayerStack& stack, std::span<const Incidence> incidences,
    const AddingDoublingOptions& options) {
  check_differentiable(stack);
  const std::vector<AddingDoublingTotals> totals =
      adding_doubling_by_angle(stack, incidences, options);
  if (totals.empty()) return {};
  std::vector<AddingDoublingDerivatives> results = derivatives_on_grid(
      stack, incidences, totals.front().nodes, of_unknown_length(options.progress));
  for (std::size_t i = 0; i < results.size(); ++i) results[i].totals = totals[i];
  return results;
}

AddingDoublingDerivatives adding_doubling_derivatives_on_grid(const LayerStack& stack,
                                                              Incidence incidence, int nodes) {
  detail::require_incidence(incidence);
  check_differentiable(stack);
  return derivatives_on_grid(stack, {&incidence, 1}, nodes, {}).front();
}

AddingDoublingDerivatives adding_doubling_derivatives(const LayerStack& stack, Incidence incidence,
                                                      const AddingDoublingOptions& options) {
  return adding_doubling_derivatives_by_angle(stack, {&incidence, 1}, options).front();
}

}  // namespace lamina
