// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/texels/skin_at_texel.h"

#include <algorithm>
#include <cassert>

namespace lamina::detail {

SkinAtTexel::SkinAtTexel(std::span<const SkinFitNumber> numbers, const SkinParameters& skin)
    : numbers_(numbers), skin_(skin) {
  assert(numbers.size() <= most_free_numbers);
}

void SkinAtTexel::set(std::span<const double> coordinates) {
  for (std::size_t n = 0; n < numbers_.size(); ++n) {
    const FitParameter& parameter = numbers_[n].parameter;
    values_[n] = fit_value(parameter, coordinates[n]);
    slopes_[n] = fit_value_derivative(parameter, coordinates[n]);
    for (double SkinParameters::*const value : numbers_[n].values) skin_.*value = values_[n];
  }
}

LayerAbsorption SkinAtTexel::absorption(const SkinSpectrum& spectrum) {
  LayerAbsorption result;
  result.sigma_a = {epidermis_absorption(skin_, spectrum), dermis_absorption(skin_, spectrum)};
  // Absorption is linear in each number by itself, so that any difference is its derivative.
  constexpr double difference = 0.01;
  for (std::size_t n = 0; n < numbers_.size(); ++n) {
    const auto set_to = [&](double value) {
      for (double SkinParameters::*const member : numbers_[n].values) skin_.*member = value;
    };
    set_to(values_[n] + difference);
    const double factor = slopes_[n] / difference;
    result.by_number[0][n] = (epidermis_absorption(skin_, spectrum) - result.sigma_a[0]) * factor;
    result.by_number[1][n] = (dermis_absorption(skin_, spectrum) - result.sigma_a[1]) * factor;
    set_to(values_[n]);
  }
  return result;
}

double coordinate_in_range(const FitParameter& parameter, double coordinate) {
  return std::clamp(coordinate, fit_coordinate(parameter, parameter.low),
                    fit_coordinate(parameter, parameter.high));
}

}  // namespace lamina::detail
