// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "acquire_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>

#include "lamina/base/core/number_text.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/plot/correlation_picture.h"
#include "lamina/base/plot/html_page.h"
#include "lamina/base/plot/map_picture.h"
#include "lamina/base/plot/plot.h"
#include "lamina/skin/fit/skin/number_unit.h"

namespace lamina::cli {
namespace {

constexpr std::string_view acquire_style = R"css(
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 15rem), 1fr)); gap: 1rem; margin: .8rem 0; }
.pictures figure img { width: 100%; background: var(--tint); image-rendering: auto; }
.scale { display: flex; gap: .5rem; align-items: center; font-size: .78rem; color: var(--soft); font-variant-numeric: tabular-nums; }
.scale i { flex: 1; height: .55rem; border-radius: .2rem; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: .6rem; }
.untold img { filter: grayscale(1); opacity: .6; } .summary { font-size: 1.05rem; }
@media print { figure, tr { break-inside: avoid; } }
)css";

std::string page_section(std::string_view title, const std::string& html) {
  return "<h2>" + std::string(title) + "</h2>" + html;
}

std::string picture(const Image& image, const std::string& caption) {
  const std::vector<std::byte> png = encode_png(image);
  return "<figure><img src=\"" +
         data_address("image/png", {reinterpret_cast<const char*>(png.data()), png.size()}) +
         "\" alt=\"" + html_escaped(caption) + "\"><figcaption>" + html_escaped(caption) +
         "</figcaption></figure>";
}

/// The bands of an image for the eye: three as they are, of others the first, middle and last, by
/// wavelength from blue to red, brightened alike.
Image for_eyes(const Image& bands) {
  const std::size_t count = bands.channel_count();
  const bool is_color = bands.channels == std::vector<std::string>{"R", "G", "B"};
  const std::array<std::size_t, 3> from = is_color
                                              ? std::array<std::size_t, 3>{0, 1, 2}
                                              : std::array<std::size_t, 3>{count - 1, count / 2, 0};
  Image image = make_image(bands.width, bands.height, {"R", "G", "B"});
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = bands.pixels[i / 3 * count + from[i % 3]];
  return image;
}

/// A picture that is transparent elsewhere.
Image shown_only(const Image& image, const std::function<bool(std::size_t)>& is_shown) {
  Image picture = make_image(image.width, image.height, {"R", "G", "B", "A"});
  for (std::size_t i = 0; 4 * i < picture.pixels.size(); ++i) {
    if (!is_shown(i)) continue;
    for (std::size_t c = 0; c < 3; ++c) picture.pixels[4 * i + c] = image.pixels[3 * i + c];
    picture.pixels[4 * i + 3] = 1.0f;
  }
  return picture;
}

/// How far apart both are, in the mean over bands of the relative difference.
Image difference_of(const AcquisitionCheck& check) {
  const std::size_t bands = check.measured.channel_count();
  Image difference = make_image(check.measured.width, check.measured.height, {"Y"});
  for (std::size_t i = 0; i < difference.pixels.size(); ++i)
    for (std::size_t b = 0; b < bands; ++b) {
      const float measured = std::max(check.measured.pixels[i * bands + b], 1e-4f);
      difference.pixels[i] += std::abs(check.predicted.pixels[i * bands + b] / measured - 1.0f) /
                              static_cast<float>(bands);
    }
  return difference;
}

std::string scale_html(const std::string& low, const std::string& high) {
  return "<div class=\"scale\">" + low + "<i style=\"background: " + map_gradient() + "\"></i>" +
         high + "</div>";
}

/// A map, every so-manieth pixel as those of the check.
Image thinned(const Image& map, const AcquisitionCheck& check) {
  const int step = picture_step(map.width, map.height);
  Image thin = make_image(check.measured.width, check.measured.height, {"Y"});
  for (int y = 0; y < thin.height; ++y)
    for (int x = 0; x < thin.width; ++x) thin.at(x, y)[0] = map.at(x * step, y * step)[0];
  return thin;
}

std::string map_html(const AcquiredNumber& number, const NumberSummary& summary,
                     const AcquisitionCheck& check) {
  const auto shown = [&](std::size_t i) { return bool(check.is_skin[i]); };
  const double width = std::max(summary.high - summary.low, 1e-12);
  const double low = summary.low - 0.05 * width, high = summary.high + 0.05 * width;
  const Image values = map_picture(thinned(number.values, check), low, high, shown);
  const double most = std::min(number.prior_deviation, 1.5 * summary.high_deviation);
  const Image errors =
      map_picture(thinned(number.deviations, check), 0.0, std::max(most, 1e-12), shown);
  const bool is_told = summary.within_share <= share_of_prior;
  std::string html = "<h3>" + html_escaped(summary.name) + "</h3><p class=\"soft\">" +
                     html_escaped(unit_of_number(summary.name)) + "</p>";
  if (is_told && summary.prior_share > share_of_prior)
    html +=
        "<p>Differences within the image are told, the level is not: it is what people have.</p>";
  if (!is_told)
    html +=
        "<p class=\"bad\">From the prior: the capture does not tell it. The map is what people "
        "of these colors have on average, not a measurement.</p>";
  html += std::string("<div class=\"pair") + (is_told ? "" : " untold") + "\"><div>" +
          picture(values, is_told ? told_text(summary) : "expected by the prior") +
          scale_html(printf_text("%.3g", low < 0.0 ? 0.0 : low), printf_text("%.3g", high)) +
          "</div><div>" + picture(errors, "standard deviation") +
          scale_html("0", deviation_text(most, summary.is_relative) +
                              (most < number.prior_deviation ? "" : ", all that is unknown")) +
          "</div></div>";
  return html;
}

std::string numbers_html(const std::vector<NumberSummary>& summaries) {
  const std::vector<HtmlColumn> columns = {
      {"number"},      {"median", true},         {"5 %", true},  {"95 %", true},
      {"error", true}, {"of the prior's", true}, {"which means"}};
  std::vector<std::vector<std::string>> rows;
  for (const NumberSummary& each : summaries) {
    const bool is_told = each.within_share <= share_of_prior;
    rows.push_back({html_escaped(each.name), printf_text("%.4g", each.median),
                    printf_text("%.4g", each.low), printf_text("%.4g", each.high),
                    deviation_text(each.deviation, each.is_relative),
                    printf_text("%.2f", each.prior_share),
                    (is_told ? "<span>" : "<span class=\"bad\">") + told_text(each) + "</span>"});
  }
  return html_table(columns, rows) +
         "<p class=\"soft\">Percentiles over the pixels that are skin. Errors are standard "
         "deviations, relative (%) of fractions and scales, of the logit of shares. Beyond .8 of "
         "the prior's the number comes from the prior.</p>";
}

/// How the residual fell, and where the maps were left.
std::string course_html(const AcquiredSkin& skin, const std::vector<NumberSummary>& summaries) {
  const InversionCourse& course = *skin.inversion;
  Plot plot;
  PlotPanel& panel = plot.panels.emplace_back();
  panel.x = {.label = "forward models", .scale = AxisScale::linear};
  panel.y = {.label = "residual over its noise", .scale = AxisScale::logarithmic};
  PlotCurve curve{.style = CurveStyle::line_and_points};
  for (const InversionStep& step : course.history) {
    curve.x.push_back(step.forwards);
    curve.y.push_back(step.in_deviations);
  }
  panel.curves.push_back(curve);
  const InversionStep& last = course.history.back();
  std::string html = "<p>" + std::string(name_of(course.stop)) +
                     printf_text(
                         ": residual %.2f %% of the mean, %.2f of its noise, after %.0f "
                         "forward models.",
                         100.0 * last.residual, last.in_deviations, last.forwards);
  if (!course.smoothness.empty()) html += " Smoothness:";
  for (std::size_t n = 0; n < course.smoothness.size() && n < summaries.size(); ++n)
    html += (n == 0 ? " " : ", ") + summaries[n].name + printf_text(" %.3g", course.smoothness[n]);
  return html + ".</p>" + html_plot(format_svg(plot), "residual over forward models");
}

std::string calibration_html(const Capture& capture, const std::vector<NumberSummary>& summaries,
                             const AcquisitionCheck& check) {
  std::vector<HtmlColumn> columns = {{"band"}};
  for (const NumberSummary& each : summaries) columns.push_back({html_escaped(each.name), true});
  std::vector<std::vector<std::string>> rows;
  for (std::size_t b = 0; b < check.by_calibration.rows; ++b) {
    std::vector<std::string>& row = rows.emplace_back(
        std::vector{html_escaped(capture.reflectance.channels[b]) + " 2 % brighter"});
    for (std::size_t n = 0; n < summaries.size(); ++n)
      row.push_back(
          printf_text(summaries[n].is_relative ? "%+.0f %%" : "%+.2f",
                      check.by_calibration(b, n) * (summaries[n].is_relative ? 100.0 : 1.0)));
  }
  return "<p>Changes of what is found at the median color if a band were calibrated 2 % too "
         "bright. "
         "The residual does not show such errors.</p>" +
         html_table(columns, rows);
}

std::string residual_text(const Capture& capture, const AcquisitionCheck& check) {
  std::string text = "What the maps reflect differs from the capture by";
  for (std::size_t b = 0; b < check.residual.size(); ++b)
    text += fmt::format("{} {:.1f} % ({})", b == 0 ? "" : ",", 100.0 * check.residual[b],
                        capture.reflectance.channels[b]);
  text += " in the root of mean squares";
  if (check.mean_difference)
    text += fmt::format("; CIEDE2000 {:.2f} in the mean, {:.2f} at the 95th percentile",
                        *check.mean_difference, *check.high_difference);
  return text + ".";
}

std::string assumed_html(const Capture& capture, const AcquiredSkin& skin) {
  std::vector<std::vector<std::string>> rows = {
      {"population", html_escaped(capture.population_name)},
      {"mirror reflection", capture.has_specular ? "part of the capture" : "not in the capture"},
      {"light",
       capture.incidence.is_diffuse
           ? "from all sides"
           : printf_text("from %.3g degrees", capture.incidence.theta * 180.0 / 3.14159265358979)},
      {"lateral transport", skin.inversion && skin.inversion->has_transport
                                ? "light travels sideways in the skin"
                                : "none: each pixel on its own"}};
  if (capture.mm_per_pixel)
    rows.push_back({"mm per pixel", printf_text("%.4g", *capture.mm_per_pixel)});
  for (const SkinParameterRange& range : skin_parameter_ranges()) {
    bool is_found = false;
    for (const SkinFitNumber& number : capture.numbers)
      is_found |= std::ranges::count(number.values, range.value) > 0;
    if (!is_found)
      rows.push_back(
          {std::string(range.name), printf_text("%.4g", capture.skin.skin.*range.value)});
  }
  const std::vector<HtmlColumn> columns = {{"what"}, {"is taken as"}};
  std::string notes;
  for (const std::string& note : capture.notes) notes += "<li>" + html_escaped(note) + "</li>";
  return (notes.empty() ? "" : "<ul>" + notes + "</ul>") + html_table(columns, rows);
}

}  // namespace

std::vector<NumberSummary> summaries_of(const AcquiredSkin& skin) {
  std::vector<NumberSummary> summaries;
  for (const AcquiredNumber& number : skin.numbers) {
    std::vector<float> values, deviations;
    for (std::size_t i = 0; i < skin.kinds.size(); ++i)
      if (skin.kinds[i] == PixelKind::skin) {
        values.push_back(number.values.pixels[i]);
        deviations.push_back(number.deviations.pixels[i]);
      }
    const auto percentile = [](std::vector<float>& of, std::size_t percent) {
      const auto at = of.begin() + static_cast<std::ptrdiff_t>((of.size() - 1) * percent / 100);
      std::ranges::nth_element(of, at);
      return static_cast<double>(*at);
    };
    summaries.push_back({.name = number.number.parameter.name,
                         .low = percentile(values, 5),
                         .median = percentile(values, 50),
                         .high = percentile(values, 95),
                         .deviation = percentile(deviations, 50),
                         .high_deviation = percentile(deviations, 95),
                         .is_relative = number.number.parameter.scale == FitScale::logarithmic,
                         .prior_share = number.prior_share,
                         .within_share = number.within_share});
  }
  return summaries;
}

std::string pixels_text(const Capture& capture, const AcquiredSkin& skin) {
  const auto share = [&](std::size_t count) {
    return 100.0 * static_cast<double>(count) / static_cast<double>(skin.kinds.size());
  };
  std::string text =
      fmt::format("{} x {} pixels: {:.1f} % skin", skin.width, skin.height, share(skin.counts[0]));
  if (skin.counts[2] > 0) {
    text += fmt::format(", {:.1f} % of no skin's color", share(skin.counts[2]));
    const auto& [dark, bright, colored] = skin.sides;
    if (dark + bright + colored > 0)
      text += fmt::format(" ({:.1f} % too dark, {:.1f} % too bright, {:.1f} % of another color)",
                          share(dark), share(bright), share(colored));
  }
  const MaskCounts counts = count_pixels(capture.mask);
  for (std::size_t f = 0; f < counts.faults.size(); ++f)
    if (counts.faults[f] > 0) {
      std::string name(enum_names<PixelFault>[f].name);
      std::ranges::replace(name, '_', ' ');
      text += fmt::format(", {:.1f} % {}", share(counts.faults[f]), name);
    }
  return text;
}

std::string deviation_text(double deviation, bool is_relative) {
  return is_relative ? printf_text("%.2g %%", 100.0 * deviation) : printf_text("%.2f", deviation);
}

std::string chi_squared_text(const Capture& capture, const AcquiredSkin& skin) {
  std::string text = "chi squared by stated errors";
  for (std::size_t b = 0; b < skin.chi_squared.size(); ++b) {
    text += printf_text("%s %.3g (%s", b == 0 ? "" : ",", skin.chi_squared[b],
                        capture.reflectance.channels[b].c_str());
    text += skin.error_growth[b] > 1.005 ? printf_text(", errors times %.3g)", skin.error_growth[b])
                                         : ")";
  }
  return text;
}

std::string told_text(const NumberSummary& number) {
  if (number.prior_share > share_of_prior)
    return number.within_share > share_of_prior ? "from the prior" : "differences only";
  return number.prior_share > 0.5 ? "told in part" : "told";
}

std::string acquire_page(const Capture& capture, const AcquiredSkin& skin,
                         const AcquisitionCheck& check, const std::string& command,
                         const std::string& file) {
  const std::string title = capture.name.empty() ? "Maps of skin" : capture.name;
  const std::vector<NumberSummary> summaries = summaries_of(skin);
  const auto shown = [&](std::size_t i) { return bool(check.is_skin[i]); };
  constexpr double full_difference = 0.1;
  std::string maps;
  std::vector<std::string> names;
  for (std::size_t n = 0; n < summaries.size(); ++n) {
    maps += map_html(skin.numbers[n], summaries[n], check);
    names.push_back(summaries[n].name);
  }
  return html_page(
      title,
      "<h1>" + html_escaped(title) + "</h1><p class=\"summary\">" + pixels_text(capture, skin) +
          ". " + residual_text(capture, check) + "</p>" +
          (skin.chi_squared.empty()
               ? ""
               : "<p>" + html_escaped(chi_squared_text(capture, skin)) + ".</p>") +
          "<div class=\"pictures\">" + picture(for_eyes(check.measured), "captured") +
          picture(shown_only(for_eyes(check.predicted), shown), "what the maps reflect") + "<div>" +
          picture(map_picture(difference_of(check), 0.0, full_difference, shown),
                  "difference, mean over bands") +
          scale_html("0", "10 %") + "</div></div>" +
          page_section("What was found, and what was not", numbers_html(summaries)) +
          page_section("Maps", maps) +
          (skin.inversion && !skin.inversion->history.empty()
               ? page_section("How it was solved", course_html(skin, summaries))
               : "") +
          page_section("What it hangs on", calibration_html(capture, summaries, check)) +
          page_section(
              "How errors go together",
              "<p class=\"soft\">Correlations at the median color. Near 1 or −1 a combination "
              "of two numbers is told well, and each of them badly.</p>" +
                  html_plot(format_correlations(names, check.correlation),
                            "correlations of the numbers")) +
          page_section("What was assumed", assumed_html(capture, skin)) +
          page_section("How it was made",
                       "<p>lamina " LAMINA_VERSION "</p><pre>" + html_escaped(command) + "</pre>" +
                           (file.empty() ? ""
                                         : "<details><summary>the capture "
                                           "file</summary><pre>" +
                                               html_escaped(file) + "</pre></details>")),
      acquire_style);
}

}  // namespace lamina::cli
