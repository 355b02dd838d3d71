// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/spectrum/band_set.h"

// Figures for papers, as SVG. Equal plots give equal bytes.
//
//   Plot plot;
//   PlotPanel& panel = plot.panels.emplace_back();
//   panel.x = {.label = "r [mm]", .scale = AxisScale::logarithmic};
//   panel.y = {.label = "R(r) [mm⁻²]", .scale = AxisScale::logarithmic};
//   panel.curves.push_back({.name = "red", .x = r, .y = profile, .color = band_color(bands, 0)});
//   save_svg(plot, "profile.svg");

namespace lamina {

enum class AxisScale { linear, logarithmic };

struct PlotAxis {
  std::string label;  ///< with its unit, as in "r [mm]"; UTF-8
  AxisScale scale = AxisScale::linear;
  std::optional<double> low, high;  ///< else what the curves need
};

enum class CurveStyle { line, dashed, dotted, points, line_and_points };

/// One curve. Points that are not finite, or not positive on a logarithmic axis, are left out and
/// the line is broken there.
struct PlotCurve {
  std::string name;  ///< in the legend; curves without a name are not in it
  std::vector<double> x, y;
  std::vector<double> error;      ///< half length of error bars [point]; empty without
  std::vector<double> low, high;  ///< edges of a shaded band [point]; empty without
  std::string color;              ///< "#rrggbb"; empty: the next of a palette
  CurveStyle style = CurveStyle::line;
  double width = 1.6;  ///< of the line [px]
};

enum class PlotPanelKind {
  cartesian,
  polar,  ///< x: angle from the normal, which points up [rad], positive to the right; y: radius
};

struct PlotPanel {
  std::string title;
  PlotPanelKind kind = PlotPanelKind::cartesian;
  PlotAxis x, y;  ///< of a polar panel only y, the radius, which starts at 0 unless logarithmic
  std::vector<PlotCurve> curves;
  std::optional<double> arrow_angle;  ///< polar: where light comes from, as x [rad]
};

struct Plot {
  std::string title;
  std::string caption;  ///< small, below, in as many lines as it takes: source, photons, ...
  std::vector<PlotPanel> panels;
  int columns = 0;  ///< of panels; 0: as nearly square as can be, wide first
  double panel_width = 400.0, panel_height = 300.0;  ///< of the data areas [px]
};

/// The plot as SVG text. @throws InvalidInput naming the curve whose arrays differ in length, or a
/// panel whose axis limits are no range.
[[nodiscard]] std::string format_svg(const Plot& plot);

/// Writes format_svg whole or not at all. @throws InvalidInput, WriteError.
void save_svg(const Plot& plot, const std::filesystem::path& file);

/// Color of a band, dark enough for lines on white: R, G, B as vermilion, bluish green and
/// blue, which eyes without red or green cones tell apart; wavelengths near their spectral colours.
[[nodiscard]] std::string band_color(const BandSet& bands, std::size_t band);

/// Label of a band in a legend: "R", "G", "B", or as in "540 nm".
[[nodiscard]] std::string band_label(const BandSet& bands, std::size_t band);

/// Colours for curves that are no bands, in order, again from the start after seven; told apart by
/// all kinds of eyes. Source: [OkabeIto2008].
[[nodiscard]] std::string palette_color(std::size_t index);

}  // namespace lamina
