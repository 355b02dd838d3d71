// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/measured/decoded_series.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include "lamina/base/core/number_text.h"
#include "lamina/skin/fit/measured/decoded_spheres.h"
#include "lamina/skin/fit/measured/decoded_timed_series.h"
#include "lamina/skin/fit/measured/measured_column.h"
#include "lamina/skin/fit/measured/measured_table.h"

namespace lamina::fit_detail {
namespace {

constexpr double largest_fraction = 1.2, largest_density = 1e9;

Incidence decode_incidence(const JsonInput& value) {
  if (value.is_number())
    return {.theta =
                value.number({.low = 0.0, .high = 90.0, .includes_high = false, .unit = "deg"}) *
                std::numbers::pi / 180.0};
  return value.choice<Incidence>({{"normal", {}}, {"diffuse", {.is_diffuse = true}}});
}

MeasuredUnit decode_unit(const JsonInput& value, MeasurementKind kind) {
  if (kind == MeasurementKind::radial_profile)
    return value.choice<MeasuredUnit>({{"1/mm2", {"1/mm2", 1.0}}, {"1/cm2", {"1/cm2", 0.01}}});
  return value.choice<MeasuredUnit>({{"fraction", {"", 1.0}}, {"percent", {"%", 0.01}}});
}

/// Totals cannot exceed 1 by more than their errors, but readings of spheres can.
void check_sums(const MeasuredTable& table, const std::array<MeasuredColumn, 3>& columns,
                bool has_spheres) {
  const auto& [r, t, unscattered] = columns;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (!has_spheres && !r.values.empty() && !t.values.empty()) {
      const double noise = 5.0 * std::hypot(r.standard_deviations[row], t.standard_deviations[row]);
      const double sum = r.values[row] + t.values[row];
      if (sum > 1.0 + noise)
        table.fail(
            row, "reflectance",
            "and transmittance must not exceed 1 together, but are " + printf_text("%.6g", sum));
    }
    if (!t.values.empty() && !unscattered.values.empty()) {
      const double noise =
          5.0 * std::hypot(t.standard_deviations[row], unscattered.standard_deviations[row]);
      if (unscattered.values[row] > t.values[row] + noise)
        table.fail(row, "unscattered_transmittance",
                   "must not exceed the transmittance, " + number_text(t.values[row]) +
                       ", but is " + number_text(unscattered.values[row]));
    }
  }
}

std::vector<std::string_view> keys_of(MeasurementKind kind) {
  std::vector<std::string_view> keys = {"kind", "unit", "file", "columns", "sd", "relative_sd"};
  for (const std::string_view column : measured_columns()) {
    if (is_timed_column(column)) continue;
    const bool is_frequency = column == "k_per_mm" || column == "fx_per_mm";
    const bool is_place = is_frequency || column == "r_mm";
    const bool is_transmitted = column.find("transmittance") != std::string_view::npos;
    if ((is_frequency && kind != MeasurementKind::spatial_frequency) ||
        (column == "r_mm" && kind != MeasurementKind::radial_profile) ||
        (is_transmitted && !is_place && kind == MeasurementKind::radial_profile) ||
        (column.starts_with("unscattered") && kind != MeasurementKind::totals))
      continue;
    keys.push_back(column);
  }
  if (kind == MeasurementKind::totals) {
    keys.insert(keys.end(), {"incidence", "specular"});
    keys.insert(keys.end(), sphere_keys.begin(), sphere_keys.end());
    keys.insert(keys.end(), iad_keys.begin(), iad_keys.end());
  }
  if (kind == MeasurementKind::spatial_frequency) keys.push_back("incidence");
  if (kind == MeasurementKind::radial_profile) keys.push_back("detector_width_mm");
  return keys;
}

/// Places and wavelengths of the rows of a table.
struct MeasuredRows {
  std::vector<double> at;           ///< k [1/mm] or r [mm]; 0 of totals
  std::vector<double> wavelengths;  ///< empty: not given
};

/// Rows over spatial frequency or radius, each place once for each wavelength.
MeasuredRows decode_rows(const JsonInput& value, const MeasuredTable& table,
                         const MeasuredSeries& series) {
  const bool has_waves = series.kind == MeasurementKind::spatial_frequency;
  const bool has_periods = has_waves && table.has("fx_per_mm");  // a period is 1 / fx
  const std::string place = !has_waves ? "r_mm" : has_periods ? "fx_per_mm" : "k_per_mm";
  if (has_periods && table.has("k_per_mm"))
    value.fail("must have \"k_per_mm\" or \"fx_per_mm\", which is k / (2 pi), but has both");
  const double unit_of_k = has_periods ? 2.0 * std::numbers::pi : 1.0;
  std::vector<double> at =
      table.numbers(place, has_waves ? closed_interval(0.0, 100.0 / unit_of_k, "1/mm")
                                     : closed_interval(1e-3, 1e3, "mm"));
  if (at.empty())
    value.fail("must have \"" + place + "\", as a column of its file or an array" +
               table.other_columns(place));
  for (double& each : at) each *= unit_of_k;
  const std::vector<double> wavelengths =
      table.numbers("wavelength_nm", closed_interval(200.0, 3000.0, "nm"));
  for (std::size_t row = 0; row < at.size(); ++row)
    for (std::size_t other = 0; other < row; ++other)
      if (at[row] == at[other] && (wavelengths.empty() || wavelengths[row] == wavelengths[other]))
        table.fail(
            row, place,
            "must be there once for each wavelength, but is " + number_text(at[row]) + " again");
  if (series.detector_width > 0.0)
    for (std::size_t row = 0; row < at.size(); ++row)
      if (at[row] <= 0.5 * series.detector_width)
        table.fail(row, place,
                   "must exceed half the width of the detector, " +
                       number_text(0.5 * series.detector_width) + " mm, but is " +
                       number_text(at[row]));
  return {std::move(at), wavelengths};
}

}  // namespace

DecodedSeries decode_series(const JsonInput& value) {
  const auto kind_value = value.peek("kind");
  if (!kind_value) value.fail("\"kind\" is required");
  DecodedSeries decoded;
  MeasuredSeries& series = decoded.series;
  series.kind = kind_value->choice<MeasurementKind>();
  if (is_timed(series.kind)) return decode_timed_series(value, series.kind);
  const JsonObject entry = value.object(keys_of(series.kind));
  const MeasuredUnit unit = decode_unit(entry.required("unit"), series.kind);
  const bool is_totals = series.kind == MeasurementKind::totals;
  if (const auto incidence = entry.optional("incidence"))
    series.incidence = decode_incidence(*incidence);
  if (!is_totals && series.incidence.theta != 0.0)
    entry.required("incidence").refuse("must be \"normal\" or \"diffuse\"");
  if (const auto width = entry.optional("detector_width_mm"))
    series.detector_width = width->number(closed_interval(0.0, 1e3, "mm"));

  MeasuredTable table(entry);
  if (is_totals) table.raise_rows();
  std::array<MeasuredColumn, 3> columns;
  for (std::size_t q = 0; q < columns.size(); ++q) {
    const auto quantity = static_cast<MeasuredQuantity>(q);
    if (q > 0 && series.kind == MeasurementKind::radial_profile) continue;
    if (quantity == MeasuredQuantity::unscattered_transmittance && !is_totals) continue;
    columns[q] =
        read_column(table, entry, quantity, unit,
                    {.low = 0.0,
                     .high = series.kind == MeasurementKind::radial_profile ? largest_density
                                                                            : largest_fraction});
  }
  if (columns[0].values.empty() && columns[1].values.empty())
    value.fail("must have \"reflectance\" or \"transmittance\", as columns of its file or arrays" +
               table.other_columns("reflectance"));
  if (table.iad() && !is_totals) entry.required("file").fail("of iad holds totals");
  const bool has_spheres = entry.has("reflectance_sphere") || entry.has("transmittance_sphere") ||
                           (table.iad() && table.iad()->spheres > 0);
  check_sums(table, columns, is_totals && has_spheres);
  if (is_totals && !columns[0].values.empty())
    series.has_specular =
        entry.required("specular").choice<bool>({{"included", true}, {"excluded", false}});

  const auto [at, wavelengths] =
      is_totals ? MeasuredRows{std::vector(table.rows(), 0.0), table.ascending_wavelengths()}
                : decode_rows(value, table, series);
  for (std::size_t q = 0; q < columns.size(); ++q)
    for (std::size_t row = 0; row < columns[q].values.size(); ++row) {
      series.points.push_back({.band = is_totals ? row : 0,
                               .quantity = static_cast<MeasuredQuantity>(q),
                               .at = at[row],
                               .value = columns[q].values[row],
                               .standard_deviation = columns[q].standard_deviations[row]});
      if (!wavelengths.empty()) decoded.wavelengths.push_back(wavelengths[row]);
    }
  if (!is_totals) return decoded;
  if (table.iad()) {
    take_iad_spheres(entry, table, series);
    return decoded;
  }
  for (const std::string_view key : iad_keys)
    if (const auto given = entry.optional(key)) given->fail("is of a file of iad, .rxt");
  decode_spheres(entry, table.rows(), series);
  return decoded;
}

}  // namespace lamina::fit_detail
