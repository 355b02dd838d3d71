// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/scaled_derivatives.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "lamina/solve/scattering/spatial_frequency/scaled_solver.h"

namespace lamina::detail {
namespace {

/// Of what a parameter is measured by: errors of the difference are some 1e-8 of the derivative.
constexpr double step_of_difference = 1e-4;

struct LayerParameter {
  double LayerDerivatives::*by;
  double& (*of)(Layer&);
  bool can_be_negative;
};
constexpr std::array<LayerParameter, 4> layer_parameters = {
    {{&LayerDerivatives::by_sigma_a, [](Layer& l) -> double& { return l.medium.sigma_a; }, false},
     {&LayerDerivatives::by_sigma_s, [](Layer& l) -> double& { return l.medium.sigma_s; }, false},
     {&LayerDerivatives::by_g, [](Layer& l) -> double& { return l.medium.g; }, true},
     {&LayerDerivatives::by_thickness, [](Layer& l) -> double& { return l.thickness; }, false}}};

LayerStack moved(const LayerStack& stack, std::size_t layer, const LayerParameter& parameter,
                 double by) {
  std::vector<Layer> layers(stack.layers().begin(), stack.layers().end());
  parameter.of(layers[layer]) += by;
  return LayerStack(std::move(layers), stack.ior_above(), stack.ior_below(), stack.ground());
}

/// How far a parameter of a layer is moved.
double step_of(const Layer& layer, const LayerParameter& parameter) {
  if (parameter.by == &LayerDerivatives::by_g)
    return step_of_difference * (1.0 - std::abs(layer.medium.g));
  const double extinction = sigma_t(layer.medium);
  const double free_path = extinction > 0.0 ? 1.0 / extinction : layer.thickness;
  if (parameter.by == &LayerDerivatives::by_thickness)
    return step_of_difference * std::min(layer.thickness, free_path);
  return step_of_difference /
         std::max(std::isfinite(layer.thickness) ? layer.thickness : 0.0, free_path);
}

/// Where a difference looks, in steps, and what it weighs there: centred, or to one side of 0.
struct Sample {
  double steps, weight;
};
std::vector<Sample> samples_of(double value, double step, const LayerParameter& parameter) {
  if (parameter.can_be_negative || value >= step) return {{-1.0, -0.5}, {1.0, 0.5}};
  return {{0.0, -1.5}, {1.0, 2.0}, {2.0, -0.5}};
}

/// to += factor * what, of all layers and parameters.
void add_times(std::vector<LayerDerivatives>& to, double factor,
               const std::vector<LayerDerivatives>& what) {
  for (std::size_t l = 0; l < to.size(); ++l)
    for (const LayerParameter& parameter : layer_parameters)
      to[l].*parameter.by += factor * (what[l].*parameter.by);
}

/// The derivatives of scale times f, scale = known / f0.
void scale_derivatives(double known, const std::vector<LayerDerivatives>& by_known, double f0,
                       const std::vector<LayerDerivatives>& by_f0, double& f,
                       std::vector<LayerDerivatives>& by_f) {
  const double scale = scale_to(known, f0);
  std::vector<LayerDerivatives> result(by_f.size());
  add_times(result, scale, by_f);
  if (known > 0.0 && f0 > 0.0) {
    add_times(result, f / f0, by_known);
    add_times(result, -scale * f / f0, by_f0);
  }
  f *= scale;
  by_f = std::move(result);
}

}  // namespace

ScaledDerivatives::ScaledDerivatives(const LayerStack& stack, int nodes, int modes,
                                     Illumination illumination, FrequencyDerivatives flux)
    : solver_(differentiate_solver(stack, make_frequency_solver(stack, nodes, modes))),
      illumination_(illumination),
      flux_(std::move(flux)) {
  if (illumination == Illumination::normal_beam) {
    single_.emplace_back(stack, nodes, modes);
    for (std::size_t l = 0; l < stack.layers().size(); ++l)
      for (const LayerParameter& parameter : layer_parameters) {
        Layer layer = stack.layers()[l];
        const double value = parameter.of(layer);
        if (!std::isfinite(value)) continue;
        const double step = step_of(layer, parameter);
        Difference& difference = differences_.emplace_back(Difference{l, parameter.by, {}});
        for (const Sample& sample : samples_of(value, step, parameter))
          difference.terms.push_back(
              {sample.weight / step,
               SingleCorrection(moved(stack, l, parameter, sample.steps * step), nodes, modes)});
      }
  }
  without_waves_ = unscaled(0.0);
}

FrequencyDerivatives ScaledDerivatives::unscaled(double k) const {
  FrequencyDerivatives found = response_derivatives(solver_, illumination_, k);
  for (const SingleCorrection& single : single_) {
    const FrequencyResponse lacking = single.at(k);
    found.response.reflectance += lacking.reflectance;
    found.response.transmittance += lacking.transmittance;
  }
  for (const Difference& difference : differences_)
    for (const auto& [weight, correction] : difference.terms) {
      const FrequencyResponse lacking = correction.at(k);
      found.reflectance[difference.layer].*difference.by += weight * lacking.reflectance;
      found.transmittance[difference.layer].*difference.by += weight * lacking.transmittance;
    }
  return found;
}

FrequencyDerivatives ScaledDerivatives::at(double k) const {
  FrequencyDerivatives found = unscaled(k);
  scale_derivatives(flux_.response.reflectance, flux_.reflectance,
                    without_waves_.response.reflectance, without_waves_.reflectance,
                    found.response.reflectance, found.reflectance);
  scale_derivatives(flux_.response.transmittance, flux_.transmittance,
                    without_waves_.response.transmittance, without_waves_.transmittance,
                    found.response.transmittance, found.transmittance);
  return found;
}

}  // namespace lamina::detail
