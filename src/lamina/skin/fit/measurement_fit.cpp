// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/measurement_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/skin/fit/predicted/measurement_model.h"

namespace lamina {
namespace {

using fit_detail::MeasurementModel;

constexpr int most_corrections = 8;
/// Moves that count as none: of the coordinate, and of its standard deviation.
constexpr double small_move = 1e-5, small_share = 0.03;
/// Times that: from where on derivatives of profiles are no longer those of the place before.
constexpr double far_move = 5.0;

/// As if nothing were known to better than 1 %: the way to the solution is then no narrow valley.
FitData blurred(FitData data) {
  for (std::size_t i = 0; i < data.measured.size(); ++i) {
    const double least = 0.01 * std::min(1.0, std::abs(data.measured[i]));
    if (data.covariance.rows > 0)
      data.covariance(i, i) = std::max(data.covariance(i, i), least * least);
    else
      data.standard_deviation[i] = std::max(data.standard_deviation[i], least);
  }
  return data;
}

std::vector<double> values_of(const FitResult& fit) {
  std::vector<double> values;
  for (const FittedParameter& parameter : fit.parameters) values.push_back(parameter.value);
  return values;
}

/// How far a fit moved, over what counts as no move.
double largest_move(const std::vector<FitParameter>& parameters, const FitResult& fit,
                    std::vector<double> from) {
  double largest = 0.0;
  for (std::size_t u = 0; u < from.size(); ++u) {
    const double move = std::abs(fit_coordinate(parameters[u], fit.parameters[u].value) -
                                 fit_coordinate(parameters[u], from[u]));
    const double sd = fit.parameters[u].standard_deviation;
    const double share = std::isfinite(sd)               ? small_share * sd
                         : fit.parameters[u].is_at_bound ? small_move
                                                         : move;
    largest = std::max(largest, move / std::max(small_move, share));
  }
  return largest;
}

/// Data whose errors have the noise of photons in them, which goes through many points together.
FitData with_noise(const FitData& data, const DenseMatrix& noise) {
  if (noise.columns == 0) return data;
  FitData with{.measured = data.measured,
               .standard_deviation = {},
               .covariance = multiply(noise, transpose(noise))};
  for (std::size_t i = 0; i < data.measured.size(); ++i)
    if (data.covariance.rows == 0)
      with.covariance(i, i) += data.standard_deviation[i] * data.standard_deviation[i];
    else
      for (std::size_t j = 0; j < data.measured.size(); ++j)
        with.covariance(i, j) += data.covariance(i, j);
  return with;
}

/// How much larger errors are with the noise of photons than without.
std::string note_of_noise(const MeasurementModel& model, const FitResult& with,
                          const FitResult& without) {
  double most = 1.0;
  for (std::size_t u = 0; u < with.parameters.size(); ++u) {
    const double sd = without.parameters[u].standard_deviation;
    if (std::isfinite(sd) && sd > 0.0 && !with.parameters[u].is_at_bound)
      most = std::max(most, with.parameters[u].standard_deviation / sd);
  }
  return "errors have the noise of " + printf_text("%.2g", model.photons()) +
         " photons in them, that correct diffusion, and are up to " + printf_text("%.2f", most) +
         " times as large for it";
}

FitResult fit_model(MeasurementModel& model, const Measurement& measurement, std::uint64_t seed) {
  std::vector<FitParameter> parameters = model.parameters();
  const FitData data = model.data();
  const FitModel as_fitted{
      .predict = [&](std::span<const double> values) { return model.predict(values); },
      .derivatives = [&](std::span<const double> values) { return model.derivatives(values); }};
  FitOptions options{.tolerance = 1e-3,
                     .robust_limit = measurement.robust_limit,
                     .prior_correlation = model.prior_correlation(),
                     .starts = measurement.starts,
                     .seed = seed};
  FitResult result = fit_parameters(parameters, blurred(data), as_fitted, options);
  const int agreeing_starts = result.agreeing_starts;
  options.starts = 1;
  options.tolerance = 1e-5;
  const auto start_at = [&](const std::vector<double>& values) {
    for (std::size_t u = 0; u < values.size(); ++u) parameters[u].start = values[u];
  };
  double move = std::numeric_limits<double>::infinity();
  for (int round = 0; round < most_corrections; ++round) {
    const std::vector<double> values = values_of(result);
    model.correct(values, move > far_move);
    start_at(values);
    result = fit_parameters(parameters, with_noise(data, model.photon_noise(values)), as_fitted,
                            options);
    move = largest_move(parameters, result, values);
    if (move <= 1.0 || !model.has_solutions()) break;
  }
  if (model.photons() > 0.0) {
    start_at(values_of(result));
    const FitResult without = fit_parameters(parameters, data, as_fitted, options);
    result.notes.push_back(note_of_noise(model, result, without));
  }
  result.degrees_of_freedom -= static_cast<std::ptrdiff_t>(model.unknown_factors());
  result.agreeing_starts = agreeing_starts;
  if (measurement.starts > 1)
    result.notes.push_back(std::to_string(agreeing_starts) + " of " +
                           std::to_string(measurement.starts) + " starts led to the same place");
  if (move > 10.0 && model.has_solutions())
    result.notes.push_back("accurate solutions still move the result by " +
                           printf_text("%.1f", small_share * move) + " of its errors");
  return result;
}

/// Puts the fit of some bands where it belongs.
void add_fit(const Measurement& measurement, const MeasurementModel& model, const FitResult& fit,
             MeasurementFit& all) {
  FittedGroup group;
  const std::vector<FitParameter> parameters = model.parameters();
  for (std::size_t u = 0; u < parameters.size(); ++u) {
    const auto [free, band] = model.unknowns()[u];
    const bool is_per_band = measurement.free[free].is_per_band;
    group.numbers.push_back(all.numbers.size());
    all.numbers.push_back({parameters[u].name, free,
                           is_per_band ? std::optional(band) : std::nullopt, fit.parameters[u]});
    all.values[free][band] = fit.parameters[u].value;
  }
  group.correlation = fit.correlation;
  all.groups.push_back(std::move(group));
  const auto places = model.places();
  for (std::size_t i = 0; i < places.size(); ++i) {
    all.predicted[places[i].series][places[i].point] = model.plain(i, fit.prediction[i]);
    all.residual[places[i].series][places[i].point] = fit.residual[i];
  }
  for (std::size_t s = 0; s < measurement.series.size(); ++s)
    if (!model.is_exact(s, values_of(fit))) all.has_exact_derivatives[s] = false;
  all.chi_squared += fit.chi_squared;
  all.prior_squares += fit.prior_squares;
  all.degrees_of_freedom += fit.degrees_of_freedom;
  all.has_converged = all.has_converged && fit.has_converged;
  for (const std::string& note : fit.notes)
    if (std::ranges::count(all.notes, note) == 0) all.notes.push_back(note);
}

}  // namespace

MeasurementFit fit_measurement(const Measurement& measurement,
                               const MeasurementFitOptions& options) {
  std::vector<std::vector<std::size_t>> groups;
  std::vector<std::size_t> bands(measurement.bands.size());
  std::iota(bands.begin(), bands.end(), std::size_t{0});
  if (std::ranges::all_of(measurement.free, &FreeNumber::is_per_band))
    for (const std::size_t band : bands) groups.push_back({band});
  else
    groups.push_back(bands);

  MeasurementTables own;
  if (!options.tables) own.prepare(measurement, of_unknown_length(options.progress));
  std::vector<MeasurementModel> models;
  for (const auto& group : groups)
    models.emplace_back(measurement, group, options.tables ? *options.tables : own,
                        of_unknown_length(options.progress));
  std::vector<FitResult> results(models.size());
  parallel_for(models.size(), [&](std::size_t i) {
    results[i] = fit_model(models[i], measurement, options.seed);
  });

  MeasurementFit fit;
  fit.has_converged = true;
  for (const FreeNumber& free : measurement.free)
    fit.values.emplace_back(free.is_per_band ? bands.size() : 1);
  fit.has_exact_derivatives.assign(measurement.series.size(), true);
  for (const MeasuredSeries& series : measurement.series) {
    fit.predicted.emplace_back(series.points.size());
    fit.residual.emplace_back(series.points.size());
  }
  for (std::size_t i = 0; i < models.size(); ++i) add_fit(measurement, models[i], results[i], fit);
  return fit;
}

}  // namespace lamina
