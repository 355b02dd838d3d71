// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "fit_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <cstddef>
#include <set>
#include <utility>

#include "material_bands.h"

namespace lamina::cli {
namespace {

constexpr std::size_t most_notes = 12;

JsonOutput finite_or_null(double value) {
  return std::isfinite(value) ? JsonOutput(value) : JsonOutput(nullptr);
}

/// A number as it is, or a list of those of all bands.
template <class T>
JsonOutput by_band(const std::vector<const FittedNumber*>& numbers, const T& value) {
  if (!numbers[0]->band) return value(numbers[0]->fitted);
  JsonOutput list = JsonOutput::array();
  for (const FittedNumber* number : numbers) list.push_back(value(number->fitted));
  return list;
}

JsonOutput free_json(const FreeNumber& free, const std::vector<const FittedNumber*>& numbers) {
  const auto of = [&](double FittedParameter::*member) {
    return by_band(numbers,
                   [&](const FittedParameter& fitted) { return finite_or_null(fitted.*member); });
  };
  JsonOutput json = {{"parameter", free.parameter.name},
                     {"scale", name_of(free.parameter.scale)},
                     {"value", of(&FittedParameter::value)},
                     {"low_error", of(&FittedParameter::low_error)},
                     {"high_error", of(&FittedParameter::high_error)},
                     {"standard_deviation", of(&FittedParameter::standard_deviation)},
                     {"is_at_bound", by_band(numbers, [](const FittedParameter& fitted) {
                        return JsonOutput(fitted.is_at_bound);
                      })}};
  if (free.parameter.prior) json["prior_share"] = of(&FittedParameter::prior_share);
  return json;
}

JsonOutput series_json(const Measurement& measurement, const MeasurementFit& fit, std::size_t s) {
  const MeasuredSeries& series = measurement.series[s];
  JsonOutput json = {{"kind", name_of(series.kind)},
                     {"derivatives", fit.has_exact_derivatives[s] ? "exact" : "differences"}};
  for (std::size_t p = 0; p < series.points.size(); ++p) {
    const MeasuredPoint& point = series.points[p];
    JsonOutput row = {{"band", band_name(measurement.bands, point.band)},
                      {"quantity", name_of(point.quantity)}};
    if (series.kind == MeasurementKind::spatial_frequency) row["k_per_mm"] = point.at;
    if (series.kind == MeasurementKind::radial_profile) row["r_mm"] = point.at;
    if (point.r > 0.0) row["r_mm"] = point.r;
    if (series.kind == MeasurementKind::time_resolved) row["t_ps"] = point.at;
    if (series.kind == MeasurementKind::frequency_modulated) row["frequency_mhz"] = point.at;
    row["measured"] = point.value;
    row["sd"] = point.standard_deviation;
    row["predicted"] = fit.predicted[s][p];
    row["residual"] = fit.residual[s][p];
    json["points"].push_back(std::move(row));
  }
  return json;
}

std::string with_error(const FittedParameter& fitted) {
  const double error = 0.5 * (fitted.low_error + fitted.high_error);
  if (!std::isfinite(error)) return fmt::format("{:11.5g} unknown  ", fitted.value);
  return fmt::format("{:11.5g} ±{:8.2g}", fitted.value, error);
}

std::string curve_name(const Measurement& measurement, const MeasuredPoint& point, bool with_band) {
  std::string name(name_of(point.quantity));
  std::ranges::replace(name, '_', ' ');
  if (point.r > 0.0) name += fmt::format(", {:g} mm", point.r);
  return with_band ? name + ", " + band_label(measurement.bands, point.band) : name;
}

double place_of_band(const BandSet& bands, std::size_t band) {
  return bands.is_rgb() ? static_cast<double>(band) : bands.wavelengths()[band];
}

PlotAxis band_axis(const BandSet& bands) {
  return {.label = bands.is_rgb() ? "band: R, G, B" : "wavelength [nm]"};
}

PlotAxis place_axis(const BandSet& bands, MeasurementKind kind) {
  switch (kind) {
    case MeasurementKind::spatial_frequency:
      return {.label = "k [1/mm]"};
    case MeasurementKind::radial_profile:
      return {.label = "r [mm]", .scale = AxisScale::logarithmic};
    case MeasurementKind::time_resolved:
      return {.label = "t [ps]"};
    case MeasurementKind::frequency_modulated:
      return {.label = "frequency [MHz]"};
    case MeasurementKind::totals:
      break;
  }
  return band_axis(bands);
}

PlotAxis value_axis(const MeasuredSeries& series) {
  const std::string unit = series.is_relative ? "a unit of its own" : "";
  switch (series.kind) {
    case MeasurementKind::radial_profile:
      return {.label = "R(r) [mm⁻²]", .scale = AxisScale::logarithmic};
    case MeasurementKind::time_resolved:
      return {.label = fmt::format("R(r, t) [{}]", unit.empty() ? "mm⁻² ps⁻¹" : unit),
              .scale = AxisScale::logarithmic};
    case MeasurementKind::frequency_modulated:
      return {.label = fmt::format("amplitude [{}]", unit.empty() ? "mm⁻²" : unit),
              .scale = AxisScale::logarithmic};
    case MeasurementKind::totals:
    case MeasurementKind::spatial_frequency:
      break;
  }
  return {.label = "fraction of the light"};
}

/// Points and lines of one quantity, and of one band and radius where the axis is not that of
/// these.
struct CurveKey {
  MeasuredQuantity quantity;
  std::size_t band;
  double r;
  auto operator<=>(const CurveKey&) const = default;
};

void add_panels(const Measurement& measurement, const MeasurementFit& fit, std::size_t s,
                Plot& plot) {
  const MeasuredSeries& series = measurement.series[s];
  const bool is_totals = series.kind == MeasurementKind::totals;
  const auto key_of = [&](const MeasuredPoint& point) {
    return CurveKey{point.quantity, is_totals ? 0 : point.band, point.r};
  };
  PlotPanel values, unscattered, phases, residuals;
  values.x = place_axis(measurement.bands, series.kind);
  unscattered.x = phases.x = residuals.x = values.x;
  values.y = value_axis(series);
  phases.y = {.label = "phase [degrees]"};
  unscattered.y = {.label = "unscattered fraction", .scale = AxisScale::logarithmic};
  residuals.y = {.label = "residual [standard deviations]"};
  double largest = 3.0;
  std::set<CurveKey> drawn;
  for (const MeasuredPoint& first : series.points) {
    if (!drawn.insert(key_of(first)).second) continue;
    const std::string color = palette_color(drawn.size() - 1);
    PlotCurve measured{
        .name = curve_name(measurement, first, !is_totals && measurement.bands.size() > 1),
        .color = color,
        .style = CurveStyle::points};
    PlotCurve fitted{.color = color};
    PlotCurve left{.name = measured.name, .color = color, .style = CurveStyle::points};
    for (std::size_t p = 0; p < series.points.size(); ++p) {
      const MeasuredPoint& point = series.points[p];
      if (key_of(point) != key_of(first)) continue;
      measured.x.push_back(is_totals ? place_of_band(measurement.bands, point.band) : point.at);
      measured.y.push_back(point.value);
      measured.error.push_back(point.standard_deviation);
      fitted.y.push_back(fit.predicted[s][p]);
      left.y.push_back(fit.residual[s][p]);
      largest = std::max(largest, 1.1 * std::abs(fit.residual[s][p]));
    }
    fitted.x = left.x = measured.x;
    PlotPanel& panel = first.quantity == MeasuredQuantity::unscattered_transmittance ? unscattered
                       : first.quantity == MeasuredQuantity::phase                   ? phases
                                                                                     : values;
    panel.curves.push_back(std::move(measured));
    panel.curves.push_back(std::move(fitted));
    residuals.curves.push_back(std::move(left));
  }
  residuals.y.low = -largest;
  residuals.y.high = largest;
  for (PlotPanel* panel : {&values, &unscattered, &phases, &residuals})
    if (!panel->curves.empty()) plot.panels.push_back(std::move(*panel));
}

/// What is free per band, with its errors.
PlotPanel found_panel(const Measurement& measurement, const MeasurementFit& fit, std::size_t f) {
  PlotPanel panel;
  panel.x = band_axis(measurement.bands);
  panel.y = {.label = measurement.free[f].parameter.name};
  PlotCurve curve{.color = palette_color(0), .style = CurveStyle::line_and_points};
  for (const FittedNumber* number : numbers_of(fit, f)) {
    curve.x.push_back(place_of_band(measurement.bands, *number->band));
    curve.y.push_back(number->fitted.value);
    const double error = 0.5 * (number->fitted.low_error + number->fitted.high_error);
    curve.error.push_back(std::isfinite(error) ? error : 0.0);
  }
  const auto [least, most] = std::ranges::minmax(curve.y);
  if (least > 0.0 && most > 10.0 * least) panel.y.scale = AxisScale::logarithmic;
  panel.curves.push_back(std::move(curve));
  return panel;
}

}  // namespace

std::vector<const FittedNumber*> numbers_of(const MeasurementFit& fit, std::size_t free) {
  std::vector<const FittedNumber*> found;
  for (const FittedNumber& number : fit.numbers)
    if (number.free == free) found.push_back(&number);
  return found;
}

JsonOutput fit_json(const Measurement& measurement, const MeasurementFit& fit) {
  JsonOutput json = {{"measurement", measurement.name},
                     {"bands", bands_json(measurement.bands)},
                     {"chi_squared", fit.chi_squared},
                     {"prior_squares", fit.prior_squares},
                     {"degrees_of_freedom", fit.degrees_of_freedom},
                     {"has_converged", fit.has_converged},
                     {"notes", fit.notes}};
  for (std::size_t f = 0; f < measurement.free.size(); ++f)
    json["free"].push_back(free_json(measurement.free[f], numbers_of(fit, f)));
  for (const FittedGroup& group : fit.groups) {
    JsonOutput names = JsonOutput::array();
    for (const std::size_t number : group.numbers) names.push_back(fit.numbers[number].name);
    json["correlations"].push_back(
        JsonOutput{{"numbers", names},
                   {"matrix", table_json(group.correlation.values, group.correlation.columns)}});
  }
  for (std::size_t s = 0; s < measurement.series.size(); ++s)
    json["measured"].push_back(series_json(measurement, fit, s));
  return json;
}

std::string fit_text(const Measurement& measurement, const MeasurementFit& fit) {
  std::size_t points = 0, width = 12;
  double largest = 0.0;
  for (const auto& residual : fit.residual) {
    points += residual.size();
    for (const double r : residual) largest = std::max(largest, std::abs(r));
  }
  std::string text = fmt::format(
      "{} numbers measured, {} fitted: chi squared {:.3g}, {} degrees of freedom; "
      "largest residual {:.2g} standard deviations\n",
      points, fit.numbers.size(), fit.chi_squared, fit.degrees_of_freedom, largest);
  for (const FreeNumber& free : measurement.free)
    width = std::max(width, free.parameter.name.size());
  std::vector<std::size_t> per_band;
  for (std::size_t f = 0; f < measurement.free.size(); ++f) {
    if (measurement.free[f].is_per_band)
      per_band.push_back(f);
    else
      text += fmt::format("{:<{}}  {}\n", measurement.free[f].parameter.name, width,
                          with_error(numbers_of(fit, f)[0]->fitted));
  }
  if (!per_band.empty()) {
    text += fmt::format("{:>6}", measurement.bands.is_rgb() ? "band" : "nm");
    for (const std::size_t f : per_band)
      text += fmt::format("  {:>{}}", measurement.free[f].parameter.name,
                          std::max<std::size_t>(21, measurement.free[f].parameter.name.size()));
    for (std::size_t band = 0; band < measurement.bands.size(); ++band) {
      text += fmt::format("\n{:>6}", band_name(measurement.bands, band));
      for (const std::size_t f : per_band)
        text += fmt::format("  {:>{}}", with_error(numbers_of(fit, f)[band]->fitted),
                            std::max<std::size_t>(21, measurement.free[f].parameter.name.size()));
    }
    text += "\n";
  }
  for (std::size_t i = 0; i < std::min(fit.notes.size(), most_notes); ++i)
    text += fmt::format("note: {}\n", fit.notes[i]);
  if (fit.notes.size() > most_notes)
    text += fmt::format("and {} notes more, in --json\n", fit.notes.size() - most_notes);
  return text;
}

Plot fit_plot(const Measurement& measurement, const MeasurementFit& fit) {
  Plot plot;
  plot.title = measurement.name;
  plot.caption = fmt::format(
      "Points: measured, with their standard deviations; lines: fitted. chi squared {:.3g}, {} "
      "degrees of freedom.",
      fit.chi_squared, fit.degrees_of_freedom);
  for (std::size_t s = 0; s < measurement.series.size(); ++s) add_panels(measurement, fit, s, plot);
  for (std::size_t f = 0; f < measurement.free.size(); ++f)
    if (measurement.free[f].is_per_band && measurement.bands.size() > 1)
      plot.panels.push_back(found_panel(measurement, fit, f));
  return plot;
}

}  // namespace lamina::cli
