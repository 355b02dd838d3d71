// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/oblique_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lamina/layers/optics/absorbing_sheet.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/heterogeneous/tables/operator_totals.h"

namespace lamina {
namespace {

/// Coordinates that vary by less do not change the gain by a tenth of a percent.
constexpr double least_range = 0.02;

/// Coordinates of a state by which the gain varies: all but the roughness, whose part is in what
/// enters.
constexpr std::array<std::size_t, 4> coordinates = {0, 1, 2, 3};

LayerStack solid_stack(const MappedStack& stack, std::span<const StateVector> states,
                       std::span<const double> absorbance) {
  std::vector<Layer> layers;
  for (std::size_t l = 0; l < states.size(); ++l) {
    // Diffuse light crosses a thin sheet on a path of twice its thickness.
    if (l > 0 && absorbance[l - 1] > 0.0)
      layers.push_back(
          absorbing_sheet(0.5 * absorbance[l - 1] / std::numbers::ln10, stack.layers[l - 1].ior));
    layers.push_back(detail::solid_layer(stack, l, state_of(states[l])));
  }
  const double ior_below =
      std::isinf(layers.back().thickness) ? layers.back().medium.ior : stack.ior_below;
  return LayerStack(std::move(layers), stack.ior_above, ior_below,
                    {.top = {}, .reflectance = stack.ground_reflectance});
}

struct Gains {
  double log_reflection = 0.0, log_transmission = 0.0;
};

Gains gains_of(const LayerStack& stack, double theta) {
  const std::array<Incidence, 2> incidences = {Incidence{}, Incidence{.theta = theta}};
  const std::vector<AddingDoublingTotals> totals =
      adding_doubling_by_angle(stack, incidences, {.accuracy = 1e-5});
  const double entered = entry_transmittance(stack, incidences[1]) / entry_transmittance(stack, {});
  const auto log_gain = [&](double at_angle, double at_normal) {
    return at_angle > 0.0 && at_normal > 0.0 ? std::log(at_angle / at_normal / entered) : 0.0;
  };
  const SlabTotals &normal = totals[0].totals, &oblique = totals[1].totals;
  return {log_gain(oblique.diffuse_reflectance, normal.diffuse_reflectance),
          log_gain(oblique.transmittance, normal.transmittance)};
}

/// The range of a coordinate over texels.
std::array<double, 2> range_of(const LayerTexels& texels, std::size_t coordinate) {
  const std::array<const std::vector<float>*, 5> numbers = {
      &texels.sigma_a, &texels.sigma_s, &texels.g, &texels.thickness, &texels.roughness};
  const auto [low, high] = std::ranges::minmax_element(*numbers[coordinate]);
  const auto of = [&](std::vector<float>::const_iterator at) {
    const auto texel = static_cast<std::size_t>(at - numbers[coordinate]->begin());
    LayerState state;
    switch (coordinate) {
      case 0:
        state.sigma_a = static_cast<double>((*numbers[0])[texel]);
        break;
      case 1:
        state.sigma_s = static_cast<double>((*numbers[1])[texel]);
        break;
      case 2:
        state.g = static_cast<double>((*numbers[2])[texel]);
        break;
      case 3:
        state.thickness = static_cast<double>((*numbers[3])[texel]);
        break;
      default:
        state.roughness = static_cast<double>((*numbers[4])[texel]);
        break;
    }
    return state_vector(state)[coordinate];
  };
  const double a = of(low), b = of(high);
  return {std::min(a, b), std::max(a, b)};
}

}  // namespace

double ObliqueLight::Parabola::within(double x) const { return std::clamp(x, low, high) - middle; }

ObliqueLight::ObliqueLight(const MappedStack& stack, std::span<const LayerTexels> texels,
                           std::span<const double> absorbance, double theta)
    : texels_(texels) {
  if (theta == 0.0) return;
  std::vector<StateVector> middle(texels.size());
  for (std::size_t l = 0; l < texels.size(); ++l)
    for (std::size_t c = 0; c < middle[l].size(); ++c) {
      const auto [low, high] = range_of(texels[l], c);
      middle[l][c] = std::isfinite(low) ? 0.5 * (low + high) : low;
    }
  const Gains here = gains_of(solid_stack(stack, middle, absorbance), theta);
  log_middle_ = here.log_reflection;
  transmission_ = std::exp(here.log_transmission - here.log_reflection);
  for (std::size_t l = 0; l < texels.size(); ++l)
    for (const std::size_t c : coordinates) {
      const auto [low, high] = range_of(texels[l], c);
      if (!(high - low > least_range)) continue;  // also where both are infinite
      const auto change = [&](double x) {
        std::vector<StateVector> states = middle;
        states[l][c] = x;
        return gains_of(solid_stack(stack, states, absorbance), theta).log_reflection - log_middle_;
      };
      const double half = 0.5 * (high - low), up = change(high), down = change(low);
      parabolas_.push_back({.layer = l,
                            .coordinate = c,
                            .low = low,
                            .middle = middle[l][c],
                            .high = high,
                            .slope = (up - down) / (2.0 * half),
                            .curvature = (up + down) / (2.0 * half * half)});
    }
}

double ObliqueLight::gain(std::size_t texel) const {
  double sum = log_middle_;
  for (const Parabola& p : parabolas_) {
    const double x = p.within(state_vector(state_of(texels_[p.layer], texel))[p.coordinate]);
    sum += x * (p.slope + x * p.curvature);
  }
  return std::exp(sum);
}

double ObliqueLight::log_gain_by_sigma_a(std::size_t layer, std::size_t texel) const {
  for (const Parabola& p : parabolas_)
    if (p.layer == layer && p.coordinate == 0) {
      const LayerState state = state_of(texels_[layer], texel);
      const double x = p.within(state_vector(state)[0]);
      return (p.slope + 2.0 * x * p.curvature) / std::max(state.sigma_a, least_coefficient);
    }
  return 0.0;
}

}  // namespace lamina
