// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lamina/base/plot/internal/plot_axis.h"
#include "lamina/base/plot/internal/svg_canvas.h"
#include "lamina/base/plot/plot.h"

// What cartesian and polar panels share: curves as chains of points in px, legends. Not installed.

namespace lamina {

/// A rectangle on the page [px].
struct PageBox {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
  [[nodiscard]] double right() const { return x + width; }
  [[nodiscard]] double bottom() const { return y + height; }
};

struct PagePoint {
  double x, y;
};
using PageChain = std::vector<PagePoint>;

/// A panel that is ready to be drawn.
struct PreparedPanel {
  const PlotPanel* panel = nullptr;
  AxisSpan x, y;
  std::vector<AxisTick> x_ticks, y_ticks;
  bool has_lower_half = false;                              ///< polar
  double left = 0.0, right = 0.0, top = 0.0, bottom = 0.0;  ///< room around the data area
  double legend_width = 0.0, legend_height = 0.0;
  int legend_corner = -1;  ///< 0, 1: top left, right; 2, 3: bottom left, right; -1: right of it
};

/// Colours of the curves, the missing ones from the palette.
[[nodiscard]] std::vector<std::string> curve_colors(const PlotPanel& panel);

/// @param data  where the data area will be.
[[nodiscard]] PreparedPanel prepare_cartesian(const PlotPanel& panel, const PageBox& data);
[[nodiscard]] PreparedPanel prepare_polar(const PlotPanel& panel, const PageBox& data);
void draw_cartesian(SvgCanvas& canvas, const PreparedPanel& prepared, const PageBox& data);
void draw_polar(SvgCanvas& canvas, const PreparedPanel& prepared, const PageBox& data);

/// Stroke and fill of a curve's line.
[[nodiscard]] std::string line_attributes(const PlotCurve& curve, const std::string& color);

/// The points of a line as SVG path data. Chains with one point become a dot.
[[nodiscard]] std::string path_data(const std::vector<PageChain>& chains);

/// Draws lines or points of a curve.
void draw_chains(SvgCanvas& canvas, const PlotCurve& curve, const std::string& color,
                 const std::vector<PageChain>& chains);

/// Settles the size of the legend and the corner of the box in which it hides nothing of the
/// chains; right of the box if there is none.
void place_legend(PreparedPanel& prepared, const PageBox& box,
                  const std::vector<std::vector<PageChain>>& chains);
void draw_legend(SvgCanvas& canvas, const PreparedPanel& prepared, const PageBox& box);

}  // namespace lamina
