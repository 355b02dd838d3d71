// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "fit_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "fit_page_tables.h"
#include "fit_report.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/plot/correlation_picture.h"

namespace lamina::cli {
namespace {

/// Groups of so many bands or fewer have a picture of their correlations each.
constexpr std::size_t most_matrices = 6;
/// Notes beyond these are folded.
constexpr std::size_t most_open_notes = 12;

constexpr std::string_view fit_style = R"css(
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 24rem), 1fr)); gap: .4rem 1rem; }
.scroll table { width: auto; min-width: 40%; } th, td { padding-right: 1.4rem; }
.matrix .plot { overflow-x: auto; } .matrix img { width: auto !important; max-width: none !important; }
.e { display: inline-block; vertical-align: middle; font-size: .72em; line-height: 1.15; text-align: left; margin-left: .25em; }
.e span { display: block; } .flag { font-size: .8em; } .summary { font-size: 1.05rem; }
@media (max-width: 40rem) { .plots .plot img { width: 100%; } }
@media print { .matrix img { max-width: 100% !important; } .plots { grid-template-columns: 1fr 1fr; } .plot, tr { break-inside: avoid; } }
)css";

std::string section(std::string_view title, const std::string& html) {
  return "<h2>" + std::string(title) + "</h2>" + html;
}

std::string notes_html(const MeasurementFit& fit) {
  if (fit.notes.empty())
    return "<p>No notes: every number is told by the data, and none hangs on another.</p>";
  const auto list = [](std::span<const std::string> notes) {
    std::string html = "<ul>";
    for (const std::string& note : notes) html += "<li>" + html_escaped(note) + "</li>";
    return html + "</ul>";
  };
  const std::span<const std::string> notes = fit.notes;
  const std::size_t first = std::min(notes.size(), most_open_notes);
  std::string html = list(notes.first(first));
  if (first < notes.size())
    html += fmt::format("<details><summary>{} more</summary>", notes.size() - first) +
            list(notes.subspan(first)) + "</details>";
  return html;
}

std::string summary_html(const MeasurementFit& fit) {
  std::size_t points = 0, beyond = 0;
  double squares = 0.0, largest = 0.0;
  for (const auto& series : fit.residual)
    for (const double r : series) {
      ++points;
      squares += r * r;
      largest = std::max(largest, std::abs(r));
      if (std::abs(r) > 2.0) ++beyond;
    }
  std::string html = fmt::format(
      "<p class=\"summary\">{} measured numbers, {} found. χ² = {:.4g} with {} degrees of freedom",
      points, fit.numbers.size(), fit.chi_squared, fit.degrees_of_freedom);
  html += fit.degrees_of_freedom > 0
              ? fmt::format(", {:.3g} for each",
                            fit.chi_squared / static_cast<double>(fit.degrees_of_freedom))
              : ", so that it says nothing of the model";
  if (fit.prior_squares > 0.0) html += fmt::format("; the priors add {:.2f}", fit.prior_squares);
  html += fmt::format(
      ". Residuals: {:.3g} standard deviations in the root of mean squares, {:.3g} at most, "
      "{} of {} beyond two.</p>",
      std::sqrt(squares / static_cast<double>(points)), largest, beyond, points);
  if (!fit.has_converged)
    html +=
        "<p class=\"bad\">The fit has not converged: values and errors are of where it "
        "stopped.</p>";
  return html;
}

std::string plots_html(const Measurement& measurement, const MeasurementFit& fit) {
  std::string html = "<div class=\"plots\">";
  for (const PlotPanel& panel : fit_plot(measurement, fit).panels)
    html += html_plot(format_svg({.panels = {panel}}), panel.y.label + " over " + panel.x.label);
  return html +
         "</div><p class=\"soft\">Points: measured, with one standard deviation; lines: "
         "fitted.</p>";
}

/// Over bands, for each pair of what is free in them.
Plot correlations_over_bands(const Measurement& measurement, const MeasurementFit& fit) {
  Plot plot;
  PlotPanel& panel = plot.panels.emplace_back();
  panel.x = {.label = measurement.bands.is_rgb() ? "band: R, G, B" : "wavelength [nm]"};
  panel.y = {.label = "correlation", .low = -1.0, .high = 1.0};
  const std::size_t count = measurement.free.size();
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = 0; b < a; ++b) {
      PlotCurve curve{
          .name = measurement.free[b].parameter.name + ", " + measurement.free[a].parameter.name,
          .style = CurveStyle::line_and_points};
      for (std::size_t band = 0; band < fit.groups.size(); ++band) {
        curve.x.push_back(measurement.bands.is_rgb() ? static_cast<double>(band)
                                                     : measurement.bands.wavelengths()[band]);
        curve.y.push_back(fit.groups[band].correlation(a, b));
      }
      panel.curves.push_back(std::move(curve));
    }
  return plot;
}

std::string correlations_html(const Measurement& measurement, const MeasurementFit& fit) {
  if (fit.groups[0].numbers.size() < 2) return "";
  if (fit.groups.size() > most_matrices)
    return section("How errors go together",
                   html_plot(format_svg(correlations_over_bands(measurement, fit)),
                             "correlations of the numbers of each band, over bands"));
  std::string html;
  for (const FittedGroup& group : fit.groups) {
    std::vector<std::string> names;
    for (const std::size_t number : group.numbers) names.push_back(fit.numbers[number].name);
    html += "<div class=\"matrix\">" +
            html_plot(format_correlations(names, group.correlation),
                      "correlations of the numbers found") +
            "</div>";
  }
  return section(
      "How errors go together",
      "<p class=\"soft\">Correlations of the errors. Near 1 or −1 the data tell a combination of "
      "two numbers well, and each of them badly.</p>" +
          (fit.groups.size() > 1 ? "<div class=\"plots\">" + html + "</div>" : html));
}

std::string making_html(const FitMaking& making) {
  std::string html = "<p>lamina " LAMINA_VERSION "</p><pre>" +
                     html_escaped(lamina_command_line(making.arguments)) + "</pre>";
  if (!making.file.empty())
    html += "<details><summary>the measurement file</summary><pre>" + html_escaped(making.file) +
            "</pre></details>";
  return html;
}

}  // namespace

std::string fit_page(const Measurement& measurement, const MeasurementFit& fit,
                     const FitMaking& making) {
  const std::string title = measurement.name.empty() ? "Fit of a measurement" : measurement.name;
  return html_page(title,
                   "<h1>" + html_escaped(title) + "</h1>" + summary_html(fit) +
                       section("What was found", found_html(measurement, fit)) +
                       section("What the measurement cannot tell", notes_html(fit)) +
                       section("Measurement and fit", plots_html(measurement, fit)) +
                       correlations_html(measurement, fit) +
                       section("What was measured", measured_html(measurement, fit)) +
                       section("What was assumed", assumed_html(measurement, fit)) +
                       section("Every point", points_html(measurement, fit)) +
                       section("How it was made", making_html(making)),
                   fit_style);
}

std::string batch_page(std::span<const BatchRow> batch, const FitMaking& making) {
  std::vector<std::string> names;  // of what is not per band: those of bands are many
  std::size_t fitted = 0;
  for (const BatchRow& each : batch) {
    if (!each.fit) continue;
    ++fitted;
    for (const FittedNumber& number : each.fit->numbers)
      if (!number.band && std::ranges::count(names, number.name) == 0) names.push_back(number.name);
  }
  HtmlColumns columns = {{"file"}, {"χ²", true}, {"degrees of freedom", true}};
  for (const std::string& name : names) columns.push_back({path_html(name), true});
  columns.push_back({"notes"});
  HtmlRows rows;
  for (const BatchRow& each : batch) {
    std::vector<std::string>& row = rows.emplace_back(std::vector{html_escaped(each.name)});
    if (!each.fit) {
      row.resize(columns.size() - 1);
      row.push_back("<span class=\"bad\">" + html_escaped(each.refusal) + "</span>");
      continue;
    }
    row.push_back(printf_text("%.4g", each.fit->chi_squared));
    row.push_back(std::to_string(each.fit->degrees_of_freedom));
    for (const std::string& name : names) {
      const auto found = std::ranges::find(each.fit->numbers, name, &FittedNumber::name);
      row.push_back(found == each.fit->numbers.end() ? "" : value_html(found->fitted));
    }
    std::string notes = each.fit->has_converged ? "" : "<span class=\"bad\">not converged</span>";
    for (const std::string& note : each.fit->notes)
      notes += (notes.empty() ? "" : "<br>") + html_escaped(note);
    row.push_back(notes.empty() ? ""
                                : "<details><summary>" + std::to_string(each.fit->notes.size()) +
                                      "</summary>" + notes + "</details>");
  }
  return html_page(
      "Fits of a batch",
      fmt::format("<h1>Fits of a batch</h1><p class=\"summary\">{} of {} files fitted.</p>", fitted,
                  batch.size()) +
          html_table(columns, rows) +
          "<p class=\"soft\">Numbers that every band has of its own are in the table of "
          "--output and in --json.</p>" +
          section("How it was made", making_html(making)),
      fit_style);
}

}  // namespace lamina::cli
