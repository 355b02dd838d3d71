// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/skin/skin_population.h"

#include <algorithm>
#include <utility>

#include "lamina/skin/fit/skin/internal/skin_population_table.h"
#include "lamina/solve/reflectance/skin_reflectance_table.h"

namespace lamina {
namespace {

SkinPopulation make_forearm_population() {
  using namespace fit_detail::forearms;
  const std::size_t n = means.size();
  SkinPopulation population;
  population.correlation = DenseMatrix(n, n);
  for (std::size_t i = 0; i < n; ++i) {
    population.names.emplace_back(names[i]);
    population.priors.push_back({.mean = means[i], .standard_deviation = deviations[i]});
  }
  for (std::size_t i = 0, next = 0; i < n; ++i) {
    population.correlation(i, i) = 1.0;
    for (std::size_t j = 0; j < i; ++j)
      population.correlation(i, j) = population.correlation(j, i) = correlations[next++];
  }
  const std::size_t points = missed.size();
  for (std::size_t w = 0; w < points; ++w)
    population.wavelengths.push_back(first_wavelength + static_cast<double>(w) * wavelength_step);
  population.missed.assign(missed.begin(), missed.end());
  population.missed_components = DenseMatrix(components.size(), points);
  for (std::size_t c = 0; c < components.size(); ++c)
    std::ranges::copy(components[c], population.missed_components.row(c).begin());
  return population;
}

}  // namespace

std::vector<SkinFitNumber> skin_fit_numbers(const SkinParameters& skin) {
  const SkinRange range = skin_fit_range(skin);
  const auto number = [&](const char* name, FitScale scale, double offset,
                          std::vector<double SkinParameters::*> values) {
    FitParameter parameter{.name = name,
                           .low = range.low.*values[0],
                           .high = range.high.*values[0],
                           .scale = scale,
                           .offset = offset};
    parameter.start = std::clamp(skin.*values[0], parameter.low, parameter.high);
    return SkinFitNumber{std::move(parameter), std::move(values)};
  };
  using S = SkinParameters;
  constexpr auto logarithmic = FitScale::logarithmic, logit = FitScale::logit;
  return {number("melanin", logarithmic, 1e-3, {&S::melanin}),
          number("melanin_blend", logit, 0.0, {&S::melanin_blend}),
          number("hemoglobin_epidermis", logarithmic, 3e-4, {&S::hemoglobin_epidermis}),
          number("hemoglobin_dermis", logarithmic, 3e-4, {&S::hemoglobin_dermis}),
          number("carotene", logarithmic, 3e-4, {&S::carotene}),
          number("saturation", logit, 0.0, {&S::saturation_dermis, &S::saturation_epidermis}),
          number("scattering_scale", logarithmic, 0.0, {&S::scattering_scale}),
          number("baseline_scale", logarithmic, 0.05, {&S::baseline_scale})};
}

SkinParameters with_numbers(SkinParameters skin, std::span<const SkinFitNumber> numbers,
                            std::span<const double> values) {
  for (std::size_t i = 0; i < numbers.size(); ++i)
    for (double SkinParameters::*const value : numbers[i].values) skin.*value = values[i];
  return skin;
}

const SkinPopulation& forearm_population() {
  static const SkinPopulation population = make_forearm_population();
  return population;
}

double at_wavelength(const SkinPopulation& population, std::span<const double> curve,
                     double wavelength) {
  const std::vector<double>& nm = population.wavelengths;
  if (nm.empty()) return 0.0;
  const auto above = std::ranges::upper_bound(nm, wavelength);
  if (above == nm.begin()) return curve.front();
  if (above == nm.end()) return curve.back();
  const auto i = static_cast<std::size_t>(above - nm.begin());
  const double share = (wavelength - nm[i - 1]) / (nm[i] - nm[i - 1]);
  return curve[i - 1] + share * (curve[i] - curve[i - 1]);
}

}  // namespace lamina
