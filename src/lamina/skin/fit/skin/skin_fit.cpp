// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/skin/skin_fit.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

/// The numbers that a sensor makes of curves over the wavelengths.
class Sensor {
 public:
  Sensor(const DenseMatrix& weights, std::size_t wavelengths, std::size_t numbers)
      : weights_(weights) {
    if (weights_.rows > 0 && (weights_.rows != numbers || weights_.columns != wavelengths))
      throw InvalidInput("sensor: must have a row for each of " + std::to_string(numbers) +
                         " numbers and a column for each of " + std::to_string(wavelengths) +
                         " wavelengths, but has " + std::to_string(weights_.rows) + " and " +
                         std::to_string(weights_.columns));
  }
  [[nodiscard]] std::vector<double> operator()(std::vector<double> curve) const {
    if (weights_.rows == 0) return curve;
    std::vector<double> sums(weights_.rows, 0.0);
    for (std::size_t i = 0; i < weights_.rows; ++i)
      for (std::size_t w = 0; w < weights_.columns; ++w) sums[i] += weights_(i, w) * curve[w];
    return sums;
  }
  [[nodiscard]] DenseMatrix operator()(const DenseMatrix& columns) const {
    return weights_.rows == 0 ? columns : multiply(weights_, columns);
  }

 private:
  const DenseMatrix& weights_;
};

std::vector<double> over_table(const SkinPopulation& population, std::span<const double> curve,
                               const SkinReflectanceTable& table) {
  std::vector<double> values;
  for (const double nm : table.wavelengths())
    values.push_back(at_wavelength(population, curve, nm));
  return values;
}

/// Priors of the numbers, and how they go together.
void use_priors(const SkinPopulation& population, std::vector<FitParameter>& parameters,
                FitOptions& options) {
  std::vector<std::size_t> known;  // [parameter] its place in the population
  for (FitParameter& parameter : parameters) {
    const auto found = std::ranges::find(population.names, parameter.name);
    if (found == population.names.end())
      throw InvalidInput(parameter.name + ": the population knows nothing of it");
    known.push_back(static_cast<std::size_t>(found - population.names.begin()));
    parameter.prior = population.priors[known.back()];
    parameter.start = std::clamp(parameter.prior->mean, parameter.low, parameter.high);
  }
  options.prior_correlation = DenseMatrix(known.size(), known.size());
  for (std::size_t i = 0; i < known.size(); ++i)
    for (std::size_t j = 0; j < known.size(); ++j)
      options.prior_correlation(i, j) = population.correlation(known[i], known[j]);
}

/// Errors of the measurement and of the model together.
DenseMatrix covariance_of(const SkinMeasurement& measurement, const SkinPopulation& population,
                          const SkinReflectanceTable& table, const Sensor& sensor) {
  const std::size_t n = measurement.measured.size();
  DenseMatrix covariance(n, n);
  for (std::size_t i = 0; i < n; ++i)
    covariance(i, i) = measurement.standard_deviation[i] * measurement.standard_deviation[i];
  for (std::size_t c = 0; c < population.missed_components.rows; ++c) {
    const std::vector<double> seen =
        sensor(over_table(population, population.missed_components.row(c), table));
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) covariance(i, j) += seen[i] * seen[j];
  }
  return covariance;
}

}  // namespace

SkinFit fit_skin(const SkinReflectanceTable& table, const SkinMeasurement& measurement,
                 const SkinParameters& skin, const std::vector<SkinFitNumber>& numbers,
                 const SkinPopulation* population, FitOptions options) {
  std::vector<FitParameter> parameters;
  std::vector<double SkinParameters::*> members;  // of all numbers, one after the other
  for (const SkinFitNumber& number : numbers) {
    parameters.push_back(number.parameter);
    members.insert(members.end(), number.values.begin(), number.values.end());
  }
  const Sensor sensor(measurement.sensor, table.wavelengths().size(), measurement.measured.size());
  std::vector<double> added(table.wavelengths().size(),
                            measurement.has_specular ? table.specular_reflectance() : 0.0);
  FitData data{.measured = measurement.measured,
               .standard_deviation = measurement.standard_deviation};
  if (population) {
    use_priors(*population, parameters, options);
    const std::vector<double> missed = over_table(*population, population->missed, table);
    for (std::size_t w = 0; w < added.size(); ++w) added[w] += missed[w];
    if (data.standard_deviation.size() == data.measured.size()) {  // else fit_parameters refuses
      data.covariance = covariance_of(measurement, *population, table, sensor);
      data.standard_deviation.clear();
    }
  }
  const auto spectrum_of = [&](std::span<const double> values) {
    std::vector<double> spectrum = table.reflectance(with_numbers(skin, numbers, values));
    for (std::size_t w = 0; w < added.size(); ++w) spectrum[w] += added[w];
    return spectrum;
  };
  const FitModel model{
      .predict = [&](std::span<const double> values) { return sensor(spectrum_of(values)); },
      .derivatives =
          [&](std::span<const double> values) {
            DenseMatrix by_members;
            (void)table.reflectance(with_numbers(skin, numbers, values), members, by_members);
            DenseMatrix derivatives(by_members.rows, numbers.size());
            for (std::size_t w = 0; w < by_members.rows; ++w)
              for (std::size_t i = 0, member = 0; i < numbers.size(); ++i)
                for (std::size_t k = 0; k < numbers[i].values.size(); ++k)
                  derivatives(w, i) += by_members(w, member++);
            return sensor(derivatives);
          }};
  SkinFit result{.skin = skin, .fit = fit_parameters(parameters, data, model, options)};
  std::vector<double> values;
  for (const FittedParameter& fitted : result.fit.parameters) values.push_back(fitted.value);
  result.skin = with_numbers(skin, numbers, values);
  result.spectrum = spectrum_of(values);
  return result;
}

std::vector<BandMisfit> misfit_of(const SkinFit& fit, const SkinReflectanceTable& table,
                                  const SkinMeasurement& measurement,
                                  const std::vector<SkinFitNumber>& numbers,
                                  const SkinPopulation* population) {
  const Sensor sensor(measurement.sensor, table.wavelengths().size(), measurement.measured.size());
  std::vector<double SkinParameters::*> members;
  for (const SkinFitNumber& number : numbers)
    members.insert(members.end(), number.values.begin(), number.values.end());
  DenseMatrix by_members;
  (void)table.reflectance(fit.skin, members, by_members);
  DenseMatrix slopes(by_members.rows, numbers.size());  // over one standard deviation of a number
  for (std::size_t n = 0, member = 0; n < numbers.size(); ++n) {
    const FitParameter& parameter = numbers[n].parameter;
    const FittedParameter& fitted = fit.fit.parameters[n];
    const double scale =
        fitted.is_at_bound || !std::isfinite(fitted.standard_deviation)
            ? 0.0
            : fitted.standard_deviation *
                  fit_value_derivative(parameter, fit_coordinate(parameter, fitted.value));
    for (std::size_t k = 0; k < numbers[n].values.size(); ++k, ++member)
      for (std::size_t w = 0; w < slopes.rows; ++w) slopes(w, n) += scale * by_members(w, member);
  }
  slopes = sensor(slopes);
  std::vector<BandMisfit> result;
  const DenseMatrix covariance =
      population ? covariance_of(measurement, *population, table, sensor) : DenseMatrix();
  for (std::size_t i = 0; i < measurement.measured.size(); ++i) {
    const double variance =
        population ? covariance(i, i) : std::pow(measurement.standard_deviation[i], 2);
    double told = 0.0;
    for (std::size_t n = 0; n < numbers.size(); ++n)
      for (std::size_t m = 0; m < numbers.size(); ++m)
        told += slopes(i, n) * (n == m ? 1.0 : fit.fit.correlation(n, m)) * slopes(i, m);
    result.push_back(
        {.squares = std::pow(measurement.measured[i] - fit.fit.prediction[i], 2) / variance,
         .left = std::max(0.0, 1.0 - told / variance),
         .count = 1.0});
  }
  return result;
}

}  // namespace lamina
