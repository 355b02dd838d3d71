// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/measured/decoded_timed_series.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "lamina/base/core/number_text.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/base/io/csv_table.h"
#include "lamina/skin/fit/measured/measured_column.h"
#include "lamina/skin/fit/measured/measured_table.h"

namespace lamina::fit_detail {
namespace {

constexpr double largest_time = 1e6, highest_frequency = 1e5;  // [ps], [MHz]

constexpr std::array<std::string_view, 6> timed_columns = {
    "t_ps", "frequency_mhz", "amplitude", "amplitude_sd", "phase_deg", "phase_deg_sd"};

/// What numbers of an entry are times, and whether times a factor that nobody knows.
std::pair<MeasuredUnit, bool> decode_timed_unit(const JsonInput& value, MeasurementKind kind) {
  using Choice = std::pair<MeasuredUnit, bool>;
  const Choice relative{{"", 1.0}, true};
  if (kind == MeasurementKind::time_resolved)
    return value.choice<Choice>({{"1/mm2/ps", {{"1/mm2/ps", 1.0}, false}},
                                 {"1/cm2/ps", {{"1/cm2/ps", 0.01}, false}},
                                 {"relative", relative}});
  return value.choice<Choice>({{"1/mm2", {{"1/mm2", 1.0}, false}},
                               {"1/cm2", {{"1/cm2", 0.01}, false}},
                               {"relative", relative}});
}

/// A Gaussian of a width at half its height, at steps of half a standard deviation, whose sum is
/// right to 1e-8.
std::vector<DelayedPart> gaussian_response(double fwhm) {
  const double sd = fwhm / std::sqrt(8.0 * std::log(2.0));
  std::vector<DelayedPart> parts;
  double sum = 0.0;
  for (int i = -10; i <= 10; ++i) {
    parts.push_back({0.5 * i * sd, std::exp(-0.125 * i * i)});
    sum += parts.back().weight;
  }
  for (DelayedPart& part : parts) part.weight /= sum;
  return parts;
}

/// What an instrument showed of a pulse, as a file of "t_ps" and "response".
std::vector<DelayedPart> measured_response(const JsonInput& value) {
  const CsvTable csv = load_csv(value.file_path(), value.memory());
  const std::size_t time = csv.column("t_ps"), response = csv.column("response");
  std::vector<DelayedPart> parts;
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    parts.push_back({csv.number(row, time, closed_interval(-largest_time, largest_time, "ps")),
                     csv.number(row, response, at_least(0.0))});
    if (row > 0 && !(parts[row].delay > parts[row - 1].delay))
      csv.fail(row, time,
               "must be later than the time before it, but is " + number_text(parts[row].delay));
  }
  if (parts.size() < 2 || parts.size() > 10'000)
    value.fail("must have 2 to 10000 rows, but has " + std::to_string(parts.size()));
  // Of straight lines from point to point.
  std::vector<double> weights(parts.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double before = parts[i > 0 ? i - 1 : 0].delay;
    const double after = parts[std::min(i + 1, parts.size() - 1)].delay;
    weights[i] = 0.5 * (after - before) * parts[i].weight;
    sum += weights[i];
  }
  if (!(sum > 0.0)) value.fail("must have a response > 0, but has none");
  for (std::size_t i = 0; i < parts.size(); ++i) parts[i].weight = weights[i] / sum;
  std::erase_if(parts, [](const DelayedPart& part) { return part.weight == 0.0; });
  return parts;
}

/// What an instrument makes of a pulse: its own width, and that of its bins.
std::vector<DelayedPart> decode_instrument(const JsonObject& entry) {
  std::vector<DelayedPart> response = {{}};
  if (const auto given = entry.optional("instrument_response"))
    response = given->is_number()
                   ? gaussian_response(given->number(
                         {.low = 0.0, .high = 1e5, .includes_low = false, .unit = "ps"}))
                   : measured_response(*given);
  const auto width = entry.optional("bin_width_ps");
  if (!width) return response;
  const double half =
      0.5 * width->number({.low = 0.0, .high = 1e5, .includes_low = false, .unit = "ps"});
  const Quadrature bin = gauss_legendre(3, -half, half);
  std::vector<DelayedPart> all;
  for (const DelayedPart& part : response)
    for (std::size_t i = 0; i < bin.nodes.size(); ++i)
      all.push_back({part.delay + bin.nodes[i], part.weight * bin.weights[i] / (2.0 * half)});
  return all;
}

/// Degrees, which have no relative errors.
MeasuredColumn read_phases(const MeasuredTable& table, const JsonObject& entry) {
  MeasuredColumn column{
      .values = table.numbers("phase_deg", closed_interval(-3600.0, 3600.0, "deg")),
      .standard_deviations = {}};
  if (column.values.empty()) return column;
  column.standard_deviations =
      table.numbers("phase_deg_sd", {.low = 0.0, .includes_low = false, .unit = "deg"});
  if (column.standard_deviations.empty())
    entry.value().fail("must say how well \"phase_deg\" is known: \"phase_deg_sd\"");
  return column;
}

void check_places(const MeasuredTable& table, double detector_width,
                  const std::vector<double>& wavelengths, const std::vector<double>& r,
                  const std::vector<double>& at, const std::string& at_name) {
  std::set<std::tuple<double, double, double>> places;
  for (std::size_t row = 0; row < at.size(); ++row) {
    if (!places.insert({wavelengths.empty() ? 0.0 : wavelengths[row], r[row], at[row]}).second)
      table.fail(row, at_name,
                 "must be there once for each wavelength and r_mm, but is " + number_text(at[row]) +
                     " again");
    if (r[row] <= 0.5 * detector_width)
      table.fail(row, "r_mm",
                 "must exceed half the width of the detector, " +
                     number_text(0.5 * detector_width) + " mm, but is " + number_text(r[row]));
  }
}

/// A curve whose factor is free must show more than noise.
void check_signal(const JsonInput& value, const DecodedSeries& decoded) {
  std::map<std::pair<double, double>, int> signals;
  const std::vector<MeasuredPoint>& points = decoded.series.points;
  const bool is_curve = decoded.series.kind == MeasurementKind::time_resolved;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (points[p].quantity == MeasuredQuantity::phase) continue;
    int& signal = signals[{decoded.wavelengths.empty() ? 0.0 : decoded.wavelengths[p],
                           is_curve ? points[p].r : 0.0}];
    if (points[p].value > 3.0 * points[p].standard_deviation) ++signal;
  }
  for (const auto& [place, signal] : signals)
    if (signal < 2)
      value.fail("must have two values above three times their errors" +
                 (is_curve ? " at r_mm " + number_text(place.second) : std::string()) +
                 ", since its unit is \"relative\", but has " + std::to_string(signal));
}

}  // namespace

bool is_timed(MeasurementKind kind) {
  return kind == MeasurementKind::time_resolved || kind == MeasurementKind::frequency_modulated;
}

bool is_timed_column(std::string_view column) {
  return std::ranges::count(timed_columns, column) > 0;
}

std::size_t count_unknown_factors(const MeasuredSeries& series) {
  if (!series.is_relative) return 0;
  std::set<std::pair<std::size_t, double>> curves;
  for (const MeasuredPoint& point : series.points)
    if (point.quantity != MeasuredQuantity::phase)
      curves.insert({point.band, series.kind == MeasurementKind::time_resolved ? point.r : 0.0});
  return curves.size();
}

DecodedSeries decode_timed_series(const JsonInput& value, MeasurementKind kind) {
  const bool is_time = kind == MeasurementKind::time_resolved;
  std::vector<std::string_view> keys = {"kind",        "unit",          "file", "sd",
                                        "relative_sd", "wavelength_nm", "r_mm", "detector_width_mm",
                                        "photons",     "columns"};
  if (is_time)
    keys.insert(keys.end(),
                {"t_ps", "reflectance", "reflectance_sd", "instrument_response", "bin_width_ps"});
  else
    keys.insert(keys.end(),
                {"frequency_mhz", "amplitude", "amplitude_sd", "phase_deg", "phase_deg_sd"});
  const JsonObject entry = value.object(keys);
  DecodedSeries decoded;
  MeasuredSeries& series = decoded.series;
  series.kind = kind;
  MeasuredUnit unit;
  std::tie(unit, series.is_relative) = decode_timed_unit(entry.required("unit"), kind);
  if (const auto width = entry.optional("detector_width_mm"))
    series.detector_width = width->number(closed_interval(0.0, 1e3, "mm"));
  if (const auto photons = entry.optional("photons"))
    series.photons = photons->number(closed_interval(1e4, 1e10));
  if (is_time) series.instrument = decode_instrument(entry);

  const MeasuredTable table(entry);
  constexpr double endless = std::numeric_limits<double>::max();
  const NumberRange range{.low = 0.0, .high = series.is_relative ? endless : 1e9};
  const std::string at_name = is_time ? "t_ps" : "frequency_mhz";
  const auto column = [&](const std::string& name, const NumberRange& in) {
    std::vector<double> numbers = table.numbers(name, in);
    if (numbers.empty())
      value.fail("must have \"" + name + "\", as a column of its file or an array");
    return numbers;
  };
  const std::vector<double> r = column("r_mm", closed_interval(0.01, 1e3, "mm"));
  const std::vector<double> at =
      column(at_name, is_time ? closed_interval(-largest_time, largest_time, "ps")
                              : closed_interval(0.1, highest_frequency, "MHz"));
  const auto first_quantity = is_time ? MeasuredQuantity::reflectance : MeasuredQuantity::amplitude;
  const std::array<std::pair<MeasuredQuantity, MeasuredColumn>, 2> columns = {
      std::pair{first_quantity, read_column(table, entry, first_quantity, unit, range)},
      std::pair{MeasuredQuantity::phase, is_time ? MeasuredColumn{} : read_phases(table, entry)}};
  if (columns[0].second.values.empty() && columns[1].second.values.empty())
    value.fail(is_time
                   ? "must have \"reflectance\", as a column of its file or an array"
                   : "must have \"amplitude\" or \"phase_deg\", as columns of its file or arrays");
  const std::vector<double> wavelengths =
      table.numbers("wavelength_nm", closed_interval(200.0, 3000.0, "nm"));
  check_places(table, series.detector_width, wavelengths, r, at, at_name);
  for (const auto& [quantity, found] : columns)
    for (std::size_t row = 0; row < found.values.size(); ++row) {
      series.points.push_back({.quantity = quantity,
                               .at = at[row],
                               .r = r[row],
                               .value = found.values[row],
                               .standard_deviation = found.standard_deviations[row]});
      if (!wavelengths.empty()) decoded.wavelengths.push_back(wavelengths[row]);
    }
  if (series.is_relative) check_signal(value, decoded);
  return decoded;
}

}  // namespace lamina::fit_detail
