// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling_derivatives/stack_derivatives.h"

#include <cstddef>
#include <numeric>
#include <utility>

namespace lamina::detail {
namespace {

double dot(const LightState& a, const LightState& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

LightState transposed_product(const Matrix& m, const LightState& x) {
  LightState y(m.columns, 0.0);
  for (std::size_t j = 0; j < m.columns; ++j)
    for (std::size_t i = 0; i < m.rows; ++i) y[j] += m(i, j) * x[i];
  return y;
}

void add(LightState& to, const LightState& what) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += what[i];
}

/// Times the signs of the states behind a crossing.
LightState signed_as(const CrossedStack& stack, std::size_t crossing, LightState state) {
  if (stack.signs.empty()) return state;
  for (std::size_t i = 0; i < state.size(); ++i) state[i] *= stack.signs[crossing][i];
  return state;
}

/// Of a total, by the change of layer k: light that arrives at the layer, and what that which
/// leaves it is worth.
double derivative(const LayerOperators& change, const LightFields& light, const LightFields& gains,
                  std::size_t k) {
  const LightState& from_above = light.down[2 * k];
  const LightState& from_below = light.up[2 * k + 1];
  const LightState& to_above = gains.up[2 * k];
  const LightState& to_below = gains.down[2 * k + 1];
  const auto at = [](const LightState& left, const Matrix& m, const LightState& right) {
    return dot(left, product(m, right));
  };
  return at(to_above, change.reflection, from_above) +
         at(to_above, change.transmission, from_below) +
         at(to_below, change.transmission, from_above) +
         at(to_below, change.reflection, from_below);
}

}  // namespace

LightFields fields_of(const CrossedStack& stack, LightState down) {
  LightFields fields;
  for (const Crossing& crossing : stack.crossings) {
    down = product(crossing.pass, down);
    fields.down.push_back(down);
    fields.up.push_back(product(crossing.reflection_below, down));
  }
  return fields;
}

/// By reciprocity the light that illumination from above brings there the other way.
LightFields gains_above(const CrossedStack& stack, const LightState& weights) {
  LightFields light = fields_of(stack, weights);
  for (std::size_t c = 0; c < stack.crossings.size(); ++c) {
    light.down[c] = signed_as(stack, c, std::move(light.down[c]));
    light.up[c] = signed_as(stack, c, std::move(light.up[c]));
  }
  return {.down = std::move(light.up), .up = std::move(light.down)};
}

/// From the bottom up for light that goes down and meets nothing above, then from the top down for
/// light that starts upward.
LightFields gains_below(const CrossedStack& stack, const LightState& weights) {
  const std::size_t count = stack.crossings.size();
  LightFields gains{std::vector<LightState>(count), std::vector<LightState>(count)};
  LightState straight = weights;
  for (std::size_t c = count; c-- > 0;) {
    gains.down[c] = straight;
    straight = transposed_product(stack.crossings[c].pass, straight);
  }
  LightState upward(stack.crossings.front().pass.columns, 0.0);  // times the signs
  for (std::size_t c = 0; c < count; ++c) {
    const Crossing& crossing = stack.crossings[c];
    upward = product(crossing.pass, upward);
    const LightState returned =
        signed_as(stack, c, transposed_product(crossing.returns, gains.down[c]));
    add(upward, product(stack.from_below[c], returned));
    gains.up[c] = signed_as(stack, c, upward);
    add(gains.down[c], signed_as(stack, c, product(crossing.reflection_below, upward)));
  }
  return gains;
}

std::vector<LayerDerivatives> derivatives_of(std::span<const DifferentiatedLayer> layers,
                                             const LightFields& light, const LightFields& gains) {
  std::vector<LayerDerivatives> derivatives;
  for (std::size_t k = 0; k < layers.size(); ++k)
    derivatives.push_back({.by_sigma_a = derivative(layers[k].by_sigma_a, light, gains, k),
                           .by_sigma_s = derivative(layers[k].by_sigma_s, light, gains, k),
                           .by_g = derivative(layers[k].by_g, light, gains, k),
                           .by_thickness = derivative(layers[k].by_thickness, light, gains, k)});
  return derivatives;
}

}  // namespace lamina::detail
