// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/plot/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <sstream>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/plot/internal/plot_panel.h"

namespace lamina {
namespace {

void check(const PlotPanel& panel) {
  for (const PlotCurve& curve : panel.curves) {
    const std::size_t size = curve.x.size();
    const auto require = [&](bool holds, const char* what, std::size_t given) {
      if (!holds)
        throw InvalidInput("curve \"" + curve.name + "\": " + what +
                           " must have as many values as x, " + std::to_string(size) +
                           ", but has " + std::to_string(given));
    };
    require(curve.y.size() == size, "y", curve.y.size());
    require(curve.error.empty() || curve.error.size() == size, "error", curve.error.size());
    require(curve.low.empty() == curve.high.empty(), "low and high of a band", curve.high.size());
    require(curve.low.empty() || curve.low.size() == size, "low", curve.low.size());
    require(curve.high.empty() || curve.high.size() == size, "high", curve.high.size());
  }
}

std::string hex_color(const std::array<double, 3>& rgb) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", static_cast<unsigned>(std::lround(rgb[0])),
                static_cast<unsigned>(std::lround(rgb[1])),
                static_cast<unsigned>(std::lround(rgb[2])));
  return text;
}

/// Line colours along the spectrum: near what the wavelengths look like, but dark enough on white,
/// lightest in the yellow, so that lightness tells apart what hue alone may not.
std::string wavelength_color(double wavelength) {
  struct TextAnchor {
    double wavelength;
    std::array<double, 3> rgb;
  };
  constexpr std::array<TextAnchor, 11> anchors = {{{380.0, {52, 20, 92}},
                                                   {400.0, {79, 26, 140}},
                                                   {435.0, {62, 62, 196}},
                                                   {470.0, {22, 119, 214}},
                                                   {505.0, {0, 158, 158}},
                                                   {540.0, {44, 150, 52}},
                                                   {575.0, {205, 166, 0}},
                                                   {610.0, {232, 113, 20}},
                                                   {645.0, {200, 26, 30}},
                                                   {700.0, {128, 10, 20}},
                                                   {1000.0, {70, 60, 60}}}};
  if (wavelength <= anchors.front().wavelength) return hex_color(anchors.front().rgb);
  for (std::size_t i = 1; i < anchors.size(); ++i) {
    const TextAnchor &below = anchors[i - 1], &above = anchors[i];
    if (wavelength > above.wavelength) continue;
    const double t = (wavelength - below.wavelength) / (above.wavelength - below.wavelength);
    std::array<double, 3> rgb{};
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = (1.0 - t) * below.rgb[c] + t * above.rgb[c];
    return hex_color(rgb);
  }
  return hex_color(anchors.back().rgb);
}

constexpr double margin = 12.0, gap = 14.0;
constexpr double caption_size = 10.0;

/// The caption in lines no wider than the figure [px], broken at spaces.
std::vector<std::string> wrapped(const std::string& caption, double width) {
  std::vector<std::string> lines;
  std::istringstream words(caption);
  for (std::string word; words >> word;) {
    if (lines.empty() || text_width(lines.back() + " " + word, caption_size) > width)
      lines.push_back(word);
    else
      lines.back() += " " + word;
  }
  return lines;
}

}  // namespace

std::string palette_color(std::size_t index) {
  constexpr std::array<const char*, 7> colors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                 "#e69f00", "#56b4e9", "#222222"};
  return colors[index % colors.size()];
}

std::string band_color(const BandSet& bands, std::size_t band) {
  constexpr std::array<const char*, 3> channels = {"#d55e00", "#009e73", "#0072b2"};
  return bands.is_rgb() ? channels[band] : wavelength_color(bands.wavelengths()[band]);
}

std::string band_label(const BandSet& bands, std::size_t band) {
  return band_name(bands, band) + (bands.is_rgb() ? "" : " nm");
}

std::string format_svg(const Plot& plot) {
  if (!(plot.panel_width >= 60.0 && plot.panel_height >= 60.0 && plot.panel_width <= 1e4 &&
        plot.panel_height <= 1e4))
    throw InvalidInput("plot: panels must be 60 to 10000 px wide and high");
  const std::size_t count = plot.panels.size();
  const std::size_t columns =
      plot.columns > 0 ? static_cast<std::size_t>(plot.columns)
                       : static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  const PageBox data{0.0, 0.0, plot.panel_width, plot.panel_height};
  std::vector<PreparedPanel> prepared;
  for (const PlotPanel& panel : plot.panels) {
    check(panel);
    prepared.push_back(panel.kind == PlotPanelKind::polar ? prepare_polar(panel, data)
                                                          : prepare_cartesian(panel, data));
  }
  // Columns and rows are as wide and high as the widest and highest of their panels.
  const std::size_t rows = count == 0 ? 0 : (count - 1) / columns + 1;
  std::vector<double> left(columns), right(columns), top(rows), bottom(rows);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t column = i % columns, row = i / columns;
    left[column] = std::max(left[column], prepared[i].left);
    right[column] = std::max(right[column], prepared[i].right);
    top[row] = std::max(top[row], prepared[i].top);
    bottom[row] = std::max(bottom[row], prepared[i].bottom);
  }
  SvgCanvas canvas;
  double y = margin;
  if (!plot.title.empty()) {
    canvas.text(margin, y + 14.0, plot.title, {.size = 15.0, .is_bold = true});
    y += 26.0;
  }
  double width = 2.0 * margin + text_width(plot.title, 16.5);
  for (std::size_t row = 0; row < rows; ++row) {
    double x = margin;
    y += top[row];
    for (std::size_t column = 0; column < columns && row * columns + column < count; ++column) {
      const PreparedPanel& panel = prepared[row * columns + column];
      x += left[column];
      const PageBox place{x, y, plot.panel_width, plot.panel_height};
      panel.panel->kind == PlotPanelKind::polar ? draw_polar(canvas, panel, place)
                                                : draw_cartesian(canvas, panel, place);
      x += plot.panel_width + right[column];
      width = std::max(width, x + margin);
      x += gap;
    }
    y += plot.panel_height + bottom[row] + (row + 1 < rows ? gap : 0.0);
  }
  y += plot.caption.empty() ? 0.0 : 4.0;
  for (const std::string& line : wrapped(plot.caption, width - 2.0 * margin)) {
    y += 14.0;
    canvas.text(margin, y, line, {.size = caption_size, .color = "#666666"});
  }
  return canvas.finish(width, y + margin);
}

void save_svg(const Plot& plot, const std::filesystem::path& file) {
  const std::string text = format_svg(plot);
  write_file_bytes(file, std::as_bytes(std::span(text)));
}

}  // namespace lamina
