// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "acquire_leaf.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lamina/base/core/number_text.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/plot/correlation_picture.h"
#include "lamina/base/plot/html_page.h"
#include "lamina/base/plot/map_picture.h"
#include "lamina/base/plot/plot.h"
#include "lamina/skin/acquire/files/leaf_files.h"
#include "lamina/skin/fit/least_squares/nonlinear_fit.h"

namespace lamina::cli {
namespace {

constexpr std::string_view leaf_style = R"css(
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 17rem), 1fr)); gap: 1rem; }
.pictures img { image-rendering: auto; background: var(--tint); } .untold img { filter: grayscale(1); opacity: .6; }
.scale { display: flex; gap: .5rem; align-items: center; font-size: .78rem; color: var(--soft); }
.scale i { flex: 1; height: .55rem; border-radius: .2rem; }
)css";

/// A number over the leaf.
struct LeafSummary {
  std::string name;
  double low = 0.0, median = 0.0, high = 0.0;
  double prior_share = 1.0;
};
std::vector<LeafSummary> leaf_summaries(const LeafMaps& leaf) {
  std::vector<LeafSummary> summaries;
  for (const LeafMap& map : leaf.maps) {
    std::vector<float> values;
    for (const float value : map.values.pixels)
      if (std::isfinite(value)) values.push_back(value);
    std::ranges::sort(values);
    const auto at = [&](std::size_t percent) {
      return static_cast<double>(values[(values.size() - 1) * percent / 100]);
    };
    summaries.push_back({map.parameter.name, at(5), at(50), at(95), map.prior_share});
  }
  return summaries;
}

std::string leaf_pixels_text(const LeafMaps& leaf) {
  return fmt::format("{} x {} pixels: {} of leaf, {} of background, {} at its edge, {} not used",
                     leaf.width, leaf.height, leaf.counts[0], leaf.counts[2], leaf.counts[3],
                     leaf.counts[1]);
}

double residual_over_bands(const LeafMaps& leaf) {
  double squares = 0.0;
  for (const double residual : leaf.residual) squares += residual * residual;
  return std::sqrt(squares / static_cast<double>(leaf.residual.size()));
}

std::string leaf_figure(const Image& image, const std::string& caption, const std::string& scale) {
  const std::vector<std::byte> png = encode_png(image);
  return "<figure><img src=\"" +
         data_address("image/png", {reinterpret_cast<const char*>(png.data()), png.size()}) +
         "\" alt=\"" + html_escaped(caption) + "\"><figcaption>" + html_escaped(caption) +
         "</figcaption>" + scale + "</figure>";
}

std::string leaf_scale(double low, double high) {
  return "<div class=\"scale\">" + printf_text("%.3g", low) +
         "<i style=\"background: " + map_gradient() + "\"></i>" + printf_text("%.3g", high) +
         "</div>";
}

/// The least, middle and largest of all bands.
std::string leaf_chi_squared_text(const LeafMaps& leaf) {
  std::vector<double> sorted = leaf.chi_squared;
  std::ranges::sort(sorted);
  return printf_text("chi squared of bands %.3g to %.3g, median %.3g", sorted.front(),
                     sorted.back(), sorted[sorted.size() / 2]);
}

Plot residual_plot(const LeafMaps& leaf, const Capture& capture) {
  Plot plot;
  PlotPanel& panel = plot.panels.emplace_back();
  panel.x = {.label = "wavelength [nm]"};
  panel.y = {.label = "measured less predicted, % of reflectance"};
  PlotCurve rms{.name = "root of mean squares"}, mean{.name = "mean"};
  for (std::size_t b = 0; b < leaf.residual.size(); ++b) {
    double nm = 0.0;
    for (std::size_t w = 0; w < capture.wavelengths.size(); ++w)
      nm += capture.sensor(b, w) * capture.wavelengths[w];
    for (PlotCurve* curve : {&rms, &mean}) curve->x.push_back(nm);
    rms.y.push_back(100.0 * leaf.residual[b]);
    mean.y.push_back(100.0 * leaf.bias[b]);
  }
  panel.curves = {rms, mean};
  return plot;
}

std::string leaf_notes(const Capture& capture) {
  std::string html;
  for (const std::string& note : capture.notes) html += "<li>" + html_escaped(note) + "</li>";
  return html.empty() ? html : "<ul>" + html + "</ul>";
}

}  // namespace

std::string leaf_text(const LeafMaps& leaf) {
  std::string text =
      leaf_pixels_text(leaf) + fmt::format("\n{:<16} {:>9} {:>9} {:>9}  of the prior's error\n", "",
                                           "median", "5 %", "95 %");
  for (const LeafSummary& each : leaf_summaries(leaf))
    text += fmt::format("{:<16} {:>9.4g} {:>9.4g} {:>9.4g}  {:.2f}{}\n", each.name, each.median,
                        each.low, each.high, each.prior_share,
                        each.prior_share > prior_share_of_note ? ", from the prior" : "");
  return text + fmt::format("residual {:.2f} % of reflectance, {}\n",
                            100.0 * residual_over_bands(leaf), leaf_chi_squared_text(leaf));
}

void add_leaf_json(const LeafMaps& leaf, const Capture& capture, const LeafFiles& files,
                   JsonOutput& json) {
  json["width"] = leaf.width;
  json["height"] = leaf.height;
  json["bands"] = capture.reflectance.channels;
  json["pixels"] = {{"leaf", leaf.counts[0]},
                    {"unused", leaf.counts[1]},
                    {"background", leaf.counts[2]},
                    {"edge", leaf.counts[3]}};
  const std::vector<LeafSummary> summaries = leaf_summaries(leaf);
  for (std::size_t n = 0; n < summaries.size(); ++n)
    json["numbers"].push_back({{"name", summaries[n].name},
                               {"file", files.maps[n].string()},
                               {"standard_deviation_file", files.deviations[n].string()},
                               {"median", summaries[n].median},
                               {"percentile_5", summaries[n].low},
                               {"percentile_95", summaries[n].high},
                               {"prior_share", summaries[n].prior_share}});
  json["residual"] = leaf.residual;
  json["chi_squared"] = leaf.chi_squared;
  json["error_growth"] = leaf.error_growth;
  json["notes"] = capture.notes;
  json["bias"] = leaf.bias;
  json["ground"] = leaf.ground;
  json["mask"] = files.mask.string();
  json["material"] = files.material.string();
  if (!files.patch.empty()) json["patch"] = files.patch.string();
}

std::string leaf_page(const LeafMaps& leaf, const Capture& capture, const std::string& command) {
  const std::string title = capture.name.empty() ? "Maps of a leaf" : capture.name;
  const std::vector<LeafSummary> summaries = leaf_summaries(leaf);
  const auto is_leaf = [&](std::size_t i) { return leaf.kinds[i] == LeafPixelKind::leaf; };
  std::string maps;
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;
  for (std::size_t n = 0; n < summaries.size(); ++n) {
    const LeafSummary& each = summaries[n];
    const bool is_told = each.prior_share <= prior_share_of_note;
    const double high = std::max(each.high, each.low + 1e-12);
    names.push_back(each.name);
    rows.push_back({html_escaped(each.name), printf_text("%.4g", each.median),
                    printf_text("%.4g", each.low), printf_text("%.4g", each.high),
                    printf_text("%.2f", each.prior_share),
                    is_told ? "told" : "<span class=\"bad\">from the prior</span>"});
    maps +=
        std::string("<div") + (is_told ? ">" : " class=\"untold\">") +
        leaf_figure(map_picture(leaf.maps[n].values, each.low, high, is_leaf),
                    each.name + (is_told ? "" : ", from the prior"), leaf_scale(each.low, high)) +
        "</div>";
  }
  const double most_misfit = 0.03;
  maps += leaf_figure(map_picture(leaf.misfit, 0.0, most_misfit, is_leaf), "misfit, over bands",
                      leaf_scale(0.0, most_misfit));
  const std::vector<HtmlColumn> columns = {
      {"number"},     {"median", true},         {"5 %", true},
      {"95 %", true}, {"of the prior's", true}, {"which means"}};
  return html_page(
      title,
      "<h1>" + html_escaped(title) + "</h1><p>" + leaf_pixels_text(leaf) +
          printf_text(". Residual %.2f %% of reflectance, ", 100.0 * residual_over_bands(leaf)) +
          leaf_chi_squared_text(leaf) + ".</p>" + leaf_notes(capture) +
          "<h2>What was found, and what was not</h2>" + html_table(columns, rows) +
          "<h2>Maps</h2><div class=\"pictures\">" + maps + "</div><h2>What is left</h2>" +
          html_plot(format_svg(residual_plot(leaf, capture)), "residuals over wavelength") +
          "<h2>How errors go together</h2>" +
          html_plot(format_correlations(names, leaf.correlation), "correlations of the numbers") +
          "<h2>How it was made</h2><p>lamina " LAMINA_VERSION "</p><pre>" + html_escaped(command) +
          "</pre>",
      leaf_style);
}

}  // namespace lamina::cli
