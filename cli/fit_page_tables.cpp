// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "fit_page_tables.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "fit_report.h"
#include "fit_units.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/plot/plot.h"

namespace lamina::cli {
namespace {

std::string words(std::string_view name) {
  std::string text(name);
  std::ranges::replace(text, '_', ' ');
  return text;
}

/// Digits after the point that leave two of an error; none if it is too small or large for such.
std::optional<int> decimals_of(double error) {
  if (!(error > 1e-7 && error < 1e4)) return std::nullopt;
  return std::max(0, 1 - static_cast<int>(std::floor(std::log10(error))));
}

std::string length_unit_of(const Measurement& measurement) {
  const JsonDocument document = parse_json(measurement.material.text, measurement.material.name);
  const auto unit = document.root().peek("length_unit");
  return unit && unit->is_string() ? unit->string() : "mm";
}

std::string band_header(const BandSet& bands) { return bands.is_rgb() ? "band" : "nm"; }

/// What points of a kind lie at, beside their band; empty for totals.
std::string place_label(MeasurementKind kind) {
  switch (kind) {
    case MeasurementKind::spatial_frequency:
      return "k [1/mm]";
    case MeasurementKind::radial_profile:
      return "r [mm]";
    case MeasurementKind::time_resolved:
      return "t [ps]";
    case MeasurementKind::frequency_modulated:
      return "f [MHz]";
    case MeasurementKind::totals:
      break;
  }
  return "";
}

std::string range_text(double low, double high) {
  return low == high ? printf_text("%.4g", low) : printf_text("%.4g to %.4g", low, high);
}

std::string geometry_text(const MeasuredSeries& series) {
  std::string text =
      series.incidence.is_diffuse ? "diffuse light"
      : series.incidence.theta > 0.0
          ? printf_text("light at %.3g°", series.incidence.theta * 180.0 / std::numbers::pi)
          : "light at normal incidence";
  const bool has_reflectance = std::ranges::count(series.points, MeasuredQuantity::reflectance,
                                                  &MeasuredPoint::quantity) > 0;
  if (series.kind == MeasurementKind::totals && has_reflectance)
    text += series.has_specular ? ", first reflection at the surface included"
                                : ", first reflection at the surface excluded";
  if (std::ranges::any_of(series.points,
                          [](const MeasuredPoint& point) { return point.sphere.has_value(); }))
    text += ", read in an integrating sphere";
  if (series.beam_diameter)
    text += printf_text(", beam %.3g mm wide, light beside the ports lost", *series.beam_diameter);
  if (const auto [near, far] = std::ranges::minmax(series.points, {}, &MeasuredPoint::r);
      far.r > 0.0)
    text += ", r = " + range_text(near.r, far.r) + " mm";
  if (series.is_relative) text += ", times an unknown factor";
  if (series.detector_width > 0.0)
    text += printf_text(", detectors %.3g mm wide", series.detector_width);
  return text;
}

std::string values_text(const std::vector<double>& values) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(values.size(), 8); ++i)
    text += (i > 0 ? ", " : "") + number_text(values[i]);
  return text + (values.size() > 8 ? fmt::format(", … ({} numbers)", values.size()) : "");
}

}  // namespace

std::string path_html(std::string_view path) { return "<code>" + html_escaped(path) + "</code>"; }

std::string value_html(const FittedParameter& fitted) {
  if (fitted.is_at_bound)
    return printf_text("%.5g", fitted.value) +
           " <span class=\"flag bad\">not told, at its range</span>";
  if (!std::isfinite(fitted.standard_deviation))
    return printf_text("%.4g", fitted.value) + " <span class=\"flag bad\">not told</span>";
  const auto decimals = decimals_of(std::min(fitted.low_error, fitted.high_error));
  const auto text = [&](double number) {
    return decimals ? printf_text("%.*f", *decimals, number) : printf_text("%.3g", number);
  };
  std::string html = text(fitted.value) + "<span class=\"e\"><span>+" + text(fitted.high_error) +
                     "</span><span>−" + text(fitted.low_error) + "</span></span>";
  if (fitted.prior_share > prior_share_of_note)
    html += " <span class=\"flag bad\">from the prior</span>";
  return html;
}

std::string found_html(const Measurement& measurement, const MeasurementFit& fit) {
  const std::string length = length_unit_of(measurement);
  HtmlRows rows;
  HtmlColumns by_band = {{.name = band_header(measurement.bands)}};
  HtmlRows band_rows(measurement.bands.size());
  for (std::size_t band = 0; band < band_rows.size(); ++band)
    band_rows[band].push_back(band_name(measurement.bands, band));
  for (std::size_t f = 0; f < measurement.free.size(); ++f) {
    const FitParameter& parameter = measurement.free[f].parameter;
    const std::string unit = unit_of(parameter.name, length);
    const auto numbers = numbers_of(fit, f);
    if (measurement.free[f].is_per_band) {
      by_band.push_back(
          {path_html(parameter.name) + (unit.empty() ? "" : " [" + unit + "]"), true});
      for (std::size_t band = 0; band < numbers.size(); ++band)
        band_rows[band].push_back(value_html(numbers[band]->fitted));
      continue;
    }
    const FittedParameter& fitted = numbers[0]->fitted;
    rows.push_back({path_html(parameter.name), value_html(fitted), unit,
                    parameter.prior ? printf_text("%.0f %%", 100.0 * fitted.prior_share) : "–"});
  }
  std::string html;
  if (!rows.empty())
    html += html_table(
        HtmlColumns{{"number"}, {"value", true}, {"unit"}, {"share of the prior", true}}, rows);
  if (by_band.size() > 1) html += html_table(by_band, band_rows);
  html +=
      "<p class=\"soft\">Errors are one standard deviation, above and below, of the curvature at "
      "the "
      "solution; they hold if the errors of the measurement do, and the model.";
  if (std::ranges::any_of(measurement.free,
                          [](const FreeNumber& free) { return free.parameter.prior.has_value(); }))
    html +=
        " The share of the prior is the standard deviation found over that of the prior: beyond "
        "80 % the number is what was known before.";
  return html + "</p>";
}

std::string measured_html(const Measurement& measurement, const MeasurementFit& fit) {
  HtmlRows rows;
  for (std::size_t s = 0; s < measurement.series.size(); ++s) {
    const MeasuredSeries& series = measurement.series[s];
    const auto [first, last] = std::ranges::minmax(series.points, {}, &MeasuredPoint::band);
    const auto [near, far] = std::ranges::minmax(series.points, {}, &MeasuredPoint::at);
    std::string at = first.band == last.band ? band_label(measurement.bands, first.band)
                                             : band_name(measurement.bands, first.band) + " to " +
                                                   band_label(measurement.bands, last.band);
    if (const std::string label = place_label(series.kind); !label.empty())
      at += ", " + label.substr(0, 1) + " = " + range_text(near.at, far.at) + " " +
            label.substr(label.find('[') + 1, label.find(']') - label.find('[') - 1);
    std::string quantities, errors;
    for (const MeasuredQuantity quantity :
         {MeasuredQuantity::reflectance, MeasuredQuantity::transmittance,
          MeasuredQuantity::unscattered_transmittance, MeasuredQuantity::amplitude,
          MeasuredQuantity::phase}) {
      const bool is_phase = quantity == MeasuredQuantity::phase;
      std::vector<double> relative;
      for (const MeasuredPoint& point : series.points)
        if (point.quantity == quantity && (is_phase || point.value > 0.0))
          relative.push_back(is_phase ? point.standard_deviation
                                      : 100.0 * point.standard_deviation / point.value);
      if (relative.empty()) continue;
      const auto [least, most] = std::ranges::minmax(relative);
      quantities += (quantities.empty() ? "" : "<br>") + words(name_of(quantity));
      errors += (errors.empty() ? "" : "<br>") +
                range_text(std::round(least * 100.0) / 100.0, std::round(most * 100.0) / 100.0) +
                (is_phase ? "°" : " %");
    }
    rows.push_back({words(name_of(series.kind)), geometry_text(series), quantities, at,
                    std::to_string(series.points.size()), errors,
                    fit.has_exact_derivatives[s] ? "exact" : "by differences"});
  }
  std::string html;
  if (!measurement.source.empty()) html += "<p>" + html_escaped(measurement.source) + "</p>";
  return html + html_table(HtmlColumns{{"kind"},
                                       {"geometry"},
                                       {"of the light"},
                                       {"at"},
                                       {"numbers", true},
                                       {"stated errors, relative", true},
                                       {"derivatives"}},
                           rows);
}

std::string assumed_html(const Measurement& measurement, const MeasurementFit& fit) {
  const std::string length = length_unit_of(measurement);
  HtmlRows ranges, held;
  for (const FreeNumber& free : measurement.free) {
    const FitParameter& parameter = free.parameter;
    std::string names;
    for (const std::string& path : free.paths())
      names += (names.empty() ? "" : ", ") + path_html(path);
    ranges.push_back(
        {names + (free.is_per_band ? ", each band" : ""),
         values_text(free.band_starts.empty() ? std::vector{parameter.start} : free.band_starts),
         number_text(parameter.low) + " to " + number_text(parameter.high),
         unit_of(parameter.name, length), std::string(name_of(parameter.scale)),
         parameter.prior ? number_text(parameter.prior->mean) + ", sd " +
                               number_text(parameter.prior->standard_deviation) +
                               (parameter.scale == FitScale::linear ? "" : " of the coordinate")
                         : "none"});
  }
  for (const StatedNumber& number : stated_numbers(measurement.material)) {
    const auto is_it = [&](const FreeNumber& free) {
      const std::vector<std::string> paths = free.paths();
      return std::ranges::count(paths, number.path) > 0;
    };
    if (std::ranges::none_of(measurement.free, is_it))
      held.push_back(
          {path_html(number.path), values_text(number.values), unit_of(number.path, length)});
  }
  std::string html =
      "<p>Flat layers, each the same throughout, whose light follows radiative "
      "transfer.</p><h3>Free</h3>" +
      html_table(
          HtmlColumns{{"number"}, {"start", true}, {"range"}, {"unit"}, {"scale"}, {"prior"}},
          ranges);
  if (!held.empty())
    html += "<h3>Taken as known</h3>" +
            html_table(HtmlColumns{{"number"}, {"value", true}, {"unit"}}, held) +
            "<p class=\"soft\">What the material does not state has the default of its format.</p>";
  if (measurement.population)
    html +=
        "<p>Priors go together as in a measured population; what its model misses of spectra is "
        "added, and its scatter counts as errors.</p>";
  if (measurement.robust_limit > 0.0)
    html += fmt::format(
        "<p>Residuals beyond {:g} standard deviations count as straight lines, not squares.</p>",
        measurement.robust_limit);

  const Material found = material_with(measurement, fit.values);
  const std::size_t bands = found.bands.size();
  std::vector<std::size_t> shown = {0};
  if (bands > 2) shown.push_back(bands / 2);
  if (bands > 1) shown.push_back(bands - 1);
  HtmlRows layers;
  for (std::size_t k = 0; k < found.layers.size(); ++k)
    for (const std::size_t band : shown) {
      const Layer layer = layer_stack(found, band).layers()[k];
      const std::string& name = found.layers[k].name;
      layers.push_back(
          {std::to_string(k) + (name.empty() ? "" : ": " + html_escaped(name)),
           band_name(found.bands, band), printf_text("%.4g", layer.medium.sigma_a),
           printf_text("%.4g", sigma_s_prime(layer.medium)), printf_text("%.3g", layer.medium.g),
           printf_text("%.4g", layer.medium.ior),
           std::isfinite(layer.thickness) ? printf_text("%.4g", layer.thickness) : "∞"});
    }
  return html + "<h3>The layers as they were found</h3>" +
         html_table(HtmlColumns{{"layer"},
                                {band_header(found.bands), true},
                                {"σa [1/mm]", true},
                                {"σs′ [1/mm]", true},
                                {"g", true},
                                {"index", true},
                                {"thickness [mm]", true}},
                    layers);
}

std::string points_html(const Measurement& measurement, const MeasurementFit& fit) {
  std::string html;
  for (std::size_t s = 0; s < measurement.series.size(); ++s) {
    const MeasuredSeries& series = measurement.series[s];
    const std::string place = place_label(series.kind);
    HtmlColumns columns = {{"quantity"}, {band_header(measurement.bands), true}};
    const bool is_at_radius = std::ranges::any_of(
        series.points, [](const MeasuredPoint& point) { return point.r > 0.0; });
    if (is_at_radius) columns.push_back({"r [mm]", true});
    if (!place.empty()) columns.push_back({place, true});
    for (const char* name : {"measured", "sd", "fitted", "residual [sd]"})
      columns.push_back({name, true});
    HtmlRows rows;
    for (std::size_t p = 0; p < series.points.size(); ++p) {
      const MeasuredPoint& point = series.points[p];
      std::vector<std::string>& row = rows.emplace_back();
      row = {words(name_of(point.quantity)), band_name(measurement.bands, point.band)};
      if (is_at_radius) row.push_back(number_text(point.r));
      if (!place.empty()) row.push_back(number_text(point.at));
      row.push_back(printf_text("%.5g", point.value));
      row.push_back(printf_text("%.2g", point.standard_deviation));
      row.push_back(printf_text("%.5g", fit.predicted[s][p]));
      row.push_back(printf_text("%+.2f", fit.residual[s][p]));
    }
    html += "<details><summary>" + words(name_of(series.kind)) + ", " +
            std::to_string(rows.size()) + " numbers</summary>" + html_table(columns, rows) +
            "</details>";
  }
  return html;
}

}  // namespace lamina::cli
