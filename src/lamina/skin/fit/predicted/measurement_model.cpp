// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/predicted/measurement_model.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/skin/fit/measured/decoded_timed_series.h"
#include "lamina/skin/fit/predicted/layer_change.h"
#include "lamina/skin/fit/predicted/series_prediction.h"

namespace lamina::fit_detail {
namespace {

/// Steps of differences, in coordinates; linear ones times the value. Accurate solutions stop
/// refining here and there, so that theirs must be long.
constexpr double short_step = 1e-4, long_step = 0.1;

/// The logarithm of a correction is a straight line no farther than this.
constexpr double longest_correction = 1.0;

/// The values of an unknown below and above another.
std::pair<double, double> sides_of(const FitParameter& parameter, double value, double step) {
  const double coordinate = fit_coordinate(parameter, value);
  if (parameter.scale == FitScale::linear && value != 0.0) step *= std::abs(value);
  return {std::max(parameter.low, fit_value(parameter, coordinate - step)),
          std::min(parameter.high, fit_value(parameter, coordinate + step))};
}

bool spans_decades(const MeasuredSeries& series, const MeasuredPoint& point) {
  const bool is_density = series.kind == MeasurementKind::radial_profile ||
                          series.kind == MeasurementKind::time_resolved;
  return (is_density || point.quantity == MeasuredQuantity::unscattered_transmittance ||
          point.quantity == MeasuredQuantity::amplitude) &&
         point.value > 3.0 * point.standard_deviation;
}

}  // namespace

MeasurementModel::MeasurementModel(const Measurement& measurement, std::vector<std::size_t> bands,
                                   const MeasurementTables& tables, Progress progress)
    : measurement_(measurement), bands_(std::move(bands)), progress_(std::move(progress)) {
  for (const MeasuredSeries& series : measurement.series)
    tables_.push_back(tables.find(measurement, series));
  for (std::size_t f = 0; f < measurement.free.size(); ++f) {
    if (!measurement.free[f].is_per_band)
      unknowns_.push_back({f, 0});
    else
      for (const std::size_t band : bands_) unknowns_.push_back({f, band});
  }
  for (const std::size_t band : bands_)
    for (std::size_t s = 0; s < measurement.series.size(); ++s) {
      const MeasuredSeries& series = measurement.series[s];
      Part part{s, band, is_logarithmic_.size(), {}, {}, nullptr};
      for (std::size_t p = 0; p < series.points.size(); ++p) {
        if (series.points[p].band != band) continue;
        part.indices.push_back(p);
        part.points.push_back(series.points[p]);
        is_logarithmic_.push_back(spans_decades(series, series.points[p]));
      }
      if (is_timed(series.kind) && !part.points.empty())
        part.timed = std::make_shared<TimedPrediction>(
            series, part.points,
            std::vector<bool>(is_logarithmic_.begin() + static_cast<std::ptrdiff_t>(part.first),
                              is_logarithmic_.end()));
      if (!part.points.empty()) (tables_[s] ? looked_up_ : parts_).push_back(std::move(part));
    }
  correction_.assign(is_logarithmic_.size(), 1.0);
  if (measurement.population) missed_ = over_rows(measurement.population->missed);
}

std::vector<FitParameter> MeasurementModel::parameters() const {
  std::vector<FitParameter> parameters;
  for (const Unknown& unknown : unknowns_) {
    const FreeNumber& free = measurement_.free[unknown.free];
    parameters.push_back(free.parameter);
    parameters.back().start = free.start(unknown.band);
    if (free.is_per_band && measurement_.bands.size() > 1)
      parameters.back().name += " at " + band_name(measurement_.bands, unknown.band) +
                                (measurement_.bands.is_rgb() ? "" : " nm");
  }
  return parameters;
}

FitData MeasurementModel::data() const {
  const std::size_t rows = is_logarithmic_.size();
  FitData data{.measured = std::vector<double>(rows),
               .standard_deviation = std::vector<double>(rows)};
  for (const auto& parts : {&parts_, &looked_up_})
    for (const Part& part : *parts)
      for (std::size_t j = 0; j < part.points.size(); ++j) {
        const MeasuredPoint& point = part.points[j];
        const std::size_t row = part.first + j;
        const bool is_log = is_logarithmic_[row];
        data.measured[row] = is_log ? std::log(point.value) : point.value;
        data.standard_deviation[row] =
            is_log ? point.standard_deviation / point.value : point.standard_deviation;
      }
  if (measurement_.population) add_missed_scatter(data);
  return data;
}

DenseMatrix MeasurementModel::prior_correlation() const {
  if (!measurement_.population) return {};
  DenseMatrix correlation(unknowns_.size(), unknowns_.size());
  for (std::size_t i = 0; i < unknowns_.size(); ++i)
    for (std::size_t j = 0; j < unknowns_.size(); ++j) {
      const auto a = measurement_.free[unknowns_[i].free].known,
                 b = measurement_.free[unknowns_[j].free].known;
      if (i == j)
        correlation(i, j) = 1.0;
      else if (a && b)
        correlation(i, j) = measurement_.population->correlation(*a, *b);
    }
  return correlation;
}

void MeasurementModel::add_missed_scatter(FitData& data) const {
  const SkinPopulation& population = *measurement_.population;
  const std::size_t rows = data.measured.size();
  data.covariance = DenseMatrix(rows, rows);
  for (std::size_t i = 0; i < rows; ++i)
    data.covariance(i, i) = data.standard_deviation[i] * data.standard_deviation[i];
  data.standard_deviation.clear();
  for (std::size_t c = 0; c < population.missed_components.rows; ++c) {
    const std::vector<double> scatter = over_rows(population.missed_components.row(c));
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j < rows; ++j) data.covariance(i, j) += scatter[i] * scatter[j];
  }
}

std::vector<double> MeasurementModel::over_rows(std::span<const double> missed) const {
  std::vector<double> values(is_logarithmic_.size(), 0.0);
  for (const auto& parts : {&parts_, &looked_up_})
    for (const Part& part : *parts) {
      if (measurement_.series[part.series].kind != MeasurementKind::totals) continue;
      const double value = at_wavelength(*measurement_.population, missed,
                                         measurement_.bands.wavelengths()[part.band]);
      for (std::size_t j = 0; j < part.points.size(); ++j)
        if (part.points[j].quantity == MeasuredQuantity::reflectance)
          values[part.first + j] = value;
    }
  return values;
}

std::vector<LayerStack> MeasurementModel::stacks(std::span<const double> values) const {
  std::vector<std::vector<double>> table;
  for (const FreeNumber& free : measurement_.free)
    table.push_back(free.starts(measurement_.bands.size()));
  for (std::size_t u = 0; u < unknowns_.size(); ++u)
    table[unknowns_[u].free][unknowns_[u].band] = values[u];
  const Material material = material_with(measurement_, table);
  std::vector<LayerStack> stacks;
  for (const std::size_t band : bands_) stacks.push_back(layer_stack(material, band));
  return stacks;
}

std::vector<double> MeasurementModel::predict(std::span<const double> values) const {
  std::vector<double> predicted = predict_model(values);
  for (std::size_t row = 0; row < missed_.size(); ++row) predicted[row] += missed_[row];
  return predicted;
}

std::vector<double> MeasurementModel::predict_model(std::span<const double> values) const {
  report_or_throw(progress_, 0.0);
  std::vector<double> predicted(is_logarithmic_.size(), std::nan(""));
  for (const Part& part : looked_up_) look_up(part, values, predicted, nullptr);
  if (parts_.empty()) return predicted;
  std::vector<LayerStack> at;
  try {
    at = stacks(values);
  } catch (const InvalidInput&) {
    return predicted;
  }
  parallel_for(parts_.size(), [&](std::size_t i) {
    const Part& part = parts_[i];
    if (part.timed) {
      std::ranges::copy(part.timed->predict(at[place_of(part.band)]),
                        predicted.begin() + static_cast<std::ptrdiff_t>(part.first));
      return;
    }
    const std::vector<CorrectionStep> steps = correction_steps(part, values);
    const auto found = predict_quickly(at[place_of(part.band)], measurement_.series[part.series],
                                       part.points, false)
                           .values;
    for (std::size_t j = 0; j < found.size(); ++j) {
      const std::size_t row = part.first + j;
      const double value = correction_at(row, steps) * found[j];
      predicted[row] = is_logarithmic_[row] ? std::log(value) : value;
    }
  });
  return predicted;
}

void MeasurementModel::look_up(const Part& part, std::span<const double> values,
                               std::span<double> predicted, DenseMatrix* derivatives) const {
  const MeasuredSeries& series = measurement_.series[part.series];
  const RecipeTotals& table = *tables_[part.series];
  std::vector<RecipeTotals::Totals> by(derivatives ? values.size() : 0);
  const RecipeTotals::Totals totals = table.at(values, part.band, by);
  for (std::size_t j = 0; j < part.points.size(); ++j) {
    const bool is_reflected = part.points[j].quantity == MeasuredQuantity::reflectance;
    const std::size_t row = part.first + j;
    predicted[row] = is_reflected ? totals.reflectance +
                                        (series.has_specular ? table.specular_reflectance() : 0.0)
                                  : totals.transmittance;
    for (std::size_t u = 0; u < by.size(); ++u)
      (*derivatives)(row, u) = is_reflected ? by[u].reflectance : by[u].transmittance;
  }
}

std::vector<MeasurementModel::Sides> MeasurementModel::both_sides(
    std::span<const double> values, const std::vector<LayerStack>& at) const {
  const std::vector<FitParameter> parameters = this->parameters();
  std::vector<Sides> sides;
  for (std::size_t f = 0; f < measurement_.free.size(); ++f) {
    Sides of_free{.value_below = {values.begin(), values.end()},
                  .value_above = {values.begin(), values.end()},
                  .below = {},
                  .above = {}};
    for (std::size_t u = 0; u < unknowns_.size(); ++u)
      if (unknowns_[u].free == f)
        std::tie(of_free.value_below[u], of_free.value_above[u]) =
            sides_of(parameters[u], values[u], short_step);
    // Where the material cannot be so, as beyond the range of a fraction, to the other side only.
    const auto look = [&](std::vector<double>& side) {
      try {
        return stacks(side);
      } catch (const InvalidInput&) {
        side.assign(values.begin(), values.end());
        return at;
      }
    };
    of_free.below = look(of_free.value_below);
    of_free.above = look(of_free.value_above);
    sides.push_back(std::move(of_free));
  }
  return sides;
}

bool MeasurementModel::is_exact(std::size_t series, std::span<const double> values) const {
  if (tables_[series]) return true;
  const std::vector<LayerStack> at = stacks(values);
  const std::vector<Sides> sides = both_sides(values, at);
  return std::ranges::all_of(parts_, [&](const Part& part) {
    const std::size_t b = place_of(part.band);
    return part.series != series ||
           (has_derivatives(at[b], measurement_.series[series]) &&
            !corrects_derivatives(measurement_.series[series]) &&
            std::ranges::all_of(sides, [&](const Sides& side) {
              return change_between(side.below[b], side.above[b]).has_value();
            }));
  });
}

DenseMatrix MeasurementModel::derivatives(std::span<const double> values) const {
  DenseMatrix jacobian(is_logarithmic_.size(), unknowns_.size());
  std::vector<double> predicted(is_logarithmic_.size());
  for (const Part& part : looked_up_) look_up(part, values, predicted, &jacobian);
  if (parts_.empty()) return jacobian;
  const std::vector<LayerStack> at = stacks(values);
  const std::vector<Sides> sides = both_sides(values, at);

  parallel_for(parts_.size(), [&](std::size_t i) {
    const Part& part = parts_[i];
    const MeasuredSeries& series = measurement_.series[part.series];
    const std::size_t b = place_of(part.band);
    if (part.timed) {
      for (std::size_t u = 0; u < unknowns_.size(); ++u) {
        if (!depends(part, u)) continue;
        const Sides& of_free = sides[unknowns_[u].free];
        const auto low = part.timed->predict(of_free.below[b]),
                   high = part.timed->predict(of_free.above[b]);
        for (std::size_t j = 0; j < low.size(); ++j)
          jacobian(part.first + j, u) =
              (high[j] - low[j]) / (of_free.value_above[u] - of_free.value_below[u]);
      }
      return;
    }
    const bool is_exact = has_derivatives(at[b], series);
    const SeriesPrediction here = predict_quickly(at[b], series, part.points, is_exact);
    const std::vector<CorrectionStep> steps = correction_steps(part, values);
    for (std::size_t u = 0; u < unknowns_.size(); ++u) {
      if (!depends(part, u)) continue;
      const Sides& of_free = sides[unknowns_[u].free];
      const LayerStack &below = of_free.below[b], &above = of_free.above[b];
      const auto change = is_exact ? change_between(below, above) : std::nullopt;
      std::vector<double> by(part.points.size());
      if (change) {
        for (std::size_t j = 0; j < by.size(); ++j)
          by[j] = derivative_along(here.derivatives[j], *change);
      } else {
        const auto low = predict_quickly(below, series, part.points, false).values;
        const auto high = predict_quickly(above, series, part.points, false).values;
        for (std::size_t j = 0; j < by.size(); ++j) by[j] = high[j] - low[j];
      }
      for (std::size_t j = 0; j < by.size(); ++j) {
        const std::size_t row = part.first + j;
        double derivative = by[j] / (of_free.value_above[u] - of_free.value_below[u]);
        if (!derivative_correction_.values.empty())
          derivative += here.values[j] * derivative_correction_(row, u) / steps[u].value_derivative;
        jacobian(row, u) =
            derivative * (is_logarithmic_[row] ? 1.0 / here.values[j] : correction_at(row, steps));
      }
    }
  });
  return jacobian;
}

std::size_t MeasurementModel::place_of(std::size_t band) const {
  return static_cast<std::size_t>(std::ranges::find(bands_, band) - bands_.begin());
}

bool MeasurementModel::depends(const Part& part, std::size_t unknown) const {
  const auto [free, band] = unknowns_[unknown];
  return !measurement_.free[free].is_per_band || band == part.band;
}

std::vector<double> MeasurementModel::coordinates(std::span<const double> values) const {
  const std::vector<FitParameter> parameters = this->parameters();
  std::vector<double> coordinates;
  for (std::size_t u = 0; u < parameters.size(); ++u)
    coordinates.push_back(fit_coordinate(parameters[u], values[u]));
  return coordinates;
}

std::vector<MeasurementModel::CorrectionStep> MeasurementModel::correction_steps(
    const Part& part, std::span<const double> values) const {
  std::vector<CorrectionStep> steps;
  if (derivative_correction_.values.empty()) return steps;
  const std::vector<FitParameter> parameters = this->parameters();
  for (std::size_t u = 0; u < parameters.size(); ++u) {
    const double at = fit_coordinate(parameters[u], values[u]), from = corrected_at_[u];
    if (measurement_.series[part.series].beam_diameter) {
      const double slope = fit_value_derivative(parameters[u], from);
      steps.push_back({(values[u] - fit_value(parameters[u], from)) / slope, slope});
    } else {
      steps.push_back({at - from, fit_value_derivative(parameters[u], at)});
    }
  }
  return steps;
}

double MeasurementModel::correction_at(std::size_t row,
                                       std::span<const CorrectionStep> steps) const {
  double logarithm = 0.0;
  for (std::size_t u = 0; u < steps.size(); ++u)
    logarithm += derivative_correction_(row, u) * steps[u].length;
  return correction_[row] *
         std::exp(std::clamp(logarithm, -longest_correction, longest_correction));
}

void MeasurementModel::correct_derivatives(std::span<const double> values) {
  if (std::ranges::none_of(parts_, [&](const Part& part) {
        return corrects_derivatives(measurement_.series[part.series]);
      }))
    return;
  const std::vector<FitParameter> parameters = this->parameters();
  derivative_correction_ = DenseMatrix(is_logarithmic_.size(), unknowns_.size());
  for (std::size_t u = 0; u < unknowns_.size(); ++u) {
    std::vector<double> below(values.begin(), values.end()), above = below;
    std::tie(below[u], above[u]) = sides_of(parameters[u], values[u], long_step);
    const double length =
        fit_coordinate(parameters[u], above[u]) - fit_coordinate(parameters[u], below[u]);
    const std::vector<LayerStack> low = stacks(below), high = stacks(above);
    for (const Part& part : parts_) {
      const MeasuredSeries& series = measurement_.series[part.series];
      if (!corrects_derivatives(series) || !depends(part, u)) continue;
      const std::size_t b = place_of(part.band);
      // How much more, by the logarithm, an accurate solution changes than a quick one.
      const auto over_quick = [&](const LayerStack& stack) {
        std::vector<double> over = predict_accurately(stack, series, part.points);
        const auto quick = predict_quickly(stack, series, part.points, false).values;
        for (std::size_t j = 0; j < over.size(); ++j) over[j] = std::log(over[j] / quick[j]);
        return over;
      };
      const auto at_low = over_quick(low[b]), at_high = over_quick(high[b]);
      for (std::size_t j = 0; j < at_low.size(); ++j) {
        const double derivative = (at_high[j] - at_low[j]) / length;
        derivative_correction_(part.first + j, u) = std::isfinite(derivative) ? derivative : 0.0;
      }
      report_or_throw(progress_, 0.0);
    }
  }
}

void MeasurementModel::correct(std::span<const double> values, bool with_derivatives) {
  if (parts_.empty()) return;
  if (with_derivatives) correct_derivatives(values);
  corrected_at_ = coordinates(values);
  const std::vector<LayerStack> at = stacks(values);
  parallel_for(parts_.size(), [&](std::size_t i) {
    const Part& part = parts_[i];
    const MeasuredSeries& series = measurement_.series[part.series];
    const std::size_t b = place_of(part.band);
    if (part.timed) {
      part.timed->correct(at[b], progress_);
      return;
    }
    const auto quick = predict_quickly(at[b], series, part.points, false).values;
    const auto right = predict_accurately(at[b], series, part.points);
    for (std::size_t j = 0; j < quick.size(); ++j)
      correction_[part.first + j] = quick[j] > 0.0 && right[j] > 0.0 ? right[j] / quick[j] : 1.0;
  });
  report_or_throw(progress_, 0.0);
}

std::size_t MeasurementModel::unknown_factors() const {
  std::size_t factors = 0;
  for (const Part& part : parts_) factors += part.timed ? part.timed->unknown_factors() : 0;
  return factors;
}

DenseMatrix MeasurementModel::photon_noise(std::span<const double> values) const {
  std::vector<std::pair<std::size_t, DenseMatrix>> of_parts;  // first row
  std::size_t columns = 0;
  for (const Part& part : parts_) {
    if (!part.timed) continue;
    of_parts.emplace_back(part.first, part.timed->noise(stacks(values)[place_of(part.band)]));
    columns += of_parts.back().second.columns;
  }
  DenseMatrix noise(is_logarithmic_.size(), columns);
  std::size_t column = 0;
  for (const auto& [first, part] : of_parts) {
    for (std::size_t i = 0; i < part.rows; ++i)
      for (std::size_t j = 0; j < part.columns; ++j) noise(first + i, column + j) = part(i, j);
    column += part.columns;
  }
  return noise;
}

double MeasurementModel::photons() const {
  double most = 0.0;
  for (const Part& part : parts_)
    if (part.timed) most = std::max(most, part.timed->photons());
  return most;
}

std::vector<MeasurementModel::Place> MeasurementModel::places() const {
  std::vector<Place> places(is_logarithmic_.size());
  for (const auto& parts : {&parts_, &looked_up_})
    for (const Part& part : *parts)
      for (std::size_t j = 0; j < part.indices.size(); ++j)
        places[part.first + j] = {part.series, part.indices[j]};
  return places;
}

double MeasurementModel::plain(std::size_t i, double number) const {
  return is_logarithmic_[i] ? std::exp(number) : number;
}

}  // namespace lamina::fit_detail
