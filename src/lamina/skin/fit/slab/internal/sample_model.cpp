// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/slab/internal/sample_model.h"

#include <cmath>
#include <utility>

#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/adding_doubling_derivatives.h"

namespace lamina::fit_detail {

SampleModel::SampleModel(const LayerStack& stack, std::size_t sample,
                         const SlabMeasurement& measurement, const Incidence& incidence,
                         bool has_unscattered)
    : stack_(stack),
      sample_(sample),
      measurement_(measurement),
      incidence_(incidence),
      has_unscattered_(has_unscattered) {}

FitData SampleModel::data() const {
  FitData data;
  const auto add = [&](double value, double standard_deviation) {
    data.measured.push_back(value);
    data.standard_deviation.push_back(standard_deviation);
  };
  const auto& [r, t, unscattered, has_specular] = measurement_;
  add(r.value, r.standard_deviation);
  if (t) add(t->value, t->standard_deviation);
  if (has_unscattered_)
    add(std::log(unscattered->value), unscattered->standard_deviation / unscattered->value);
  return data;
}

std::vector<double> SampleModel::predict(const SampleCoefficients& is, int nodes) const {
  if (!(least_g < is.g && is.g < largest_g))
    return std::vector<double>(data().measured.size(), std::nan(""));
  const AddingDoublingTotals found = adding_doubling_on_grid(stack_of(is), incidence_, nodes);
  std::vector<double> predicted = {found.totals.diffuse_reflectance};
  if (measurement_.has_specular) predicted[0] += found.totals.specular_reflectance;
  if (measurement_.transmittance) predicted.push_back(found.totals.transmittance);
  if (has_unscattered_) predicted.push_back(std::log(found.unscattered_transmittance));
  return predicted;
}

DenseMatrix SampleModel::derivatives(const SampleCoefficients& is, int nodes) const {
  const AddingDoublingDerivatives found =
      adding_doubling_derivatives_on_grid(stack_of(is), incidence_, nodes);
  DenseMatrix jacobian(data().measured.size(), 3);
  const auto set_row = [&](std::size_t row, const LayerDerivatives& layer, double factor) {
    jacobian(row, 0) = factor * layer.by_sigma_a;
    jacobian(row, 1) = factor * layer.by_sigma_s;
    jacobian(row, 2) = factor * layer.by_g;
  };
  set_row(0, found.diffuse_reflectance[sample_], 1.0);
  if (measurement_.transmittance) set_row(1, found.transmittance[sample_], 1.0);
  if (has_unscattered_)
    set_row(2, found.unscattered_transmittance[sample_],
            1.0 / found.totals.unscattered_transmittance);
  return jacobian;
}

LayerStack SampleModel::stack_of(const SampleCoefficients& is) const {
  std::vector<Layer> layers(stack_.layers().begin(), stack_.layers().end());
  Medium& medium = layers[sample_].medium;
  medium.sigma_a = is.sigma_a;
  medium.sigma_s = is.sigma_s_prime / (1.0 - is.g);
  medium.g = is.g;
  return LayerStack(std::move(layers), stack_.ior_above(), stack_.ior_below(), stack_.ground());
}

}  // namespace lamina::fit_detail
