// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lamina/base/plot/internal/plot_panel.h"

namespace lamina {
namespace {

constexpr double font_size = 10.5;
constexpr double row_height = 16.0;
constexpr double sample_width = 22.0;
constexpr double padding = 7.0;
constexpr double inset = 9.0;  // from the frame

bool has_line(const PlotCurve& curve) { return curve.style != CurveStyle::points; }
bool has_points(const PlotCurve& curve) {
  return curve.style == CurveStyle::points || curve.style == CurveStyle::line_and_points;
}

PageBox legend_box(const PreparedPanel& prepared, const PageBox& box, int corner) {
  const double width = prepared.legend_width, height = prepared.legend_height;
  if (corner < 0) return {box.right() + 12.0, box.y, width, height};
  return {corner % 2 == 0 ? box.x + inset : box.right() - inset - width,
          corner / 2 == 0 ? box.y + inset : box.bottom() - inset - height, width, height};
}

/// How many steps of 2 px along the chains lie in the box.
int hidden_length(const std::vector<std::vector<PageChain>>& curves, const PageBox& box) {
  int hidden = 0;
  const auto count = [&](double x, double y) {
    if (x > box.x - 4.0 && x < box.right() + 4.0 && y > box.y - 4.0 && y < box.bottom() + 4.0)
      ++hidden;
  };
  for (const auto& chains : curves)
    for (const PageChain& chain : chains)
      for (std::size_t i = 0; i < chain.size(); ++i) {
        count(chain[i].x, chain[i].y);
        if (i == 0) continue;
        const double dx = chain[i].x - chain[i - 1].x, dy = chain[i].y - chain[i - 1].y;
        const int steps = static_cast<int>(std::min(std::hypot(dx, dy) / 2.0, 2000.0));
        for (int step = 1; step < steps; ++step)
          count(chain[i].x - dx * step / steps, chain[i].y - dy * step / steps);
      }
  return hidden;
}

}  // namespace

std::vector<std::string> curve_colors(const PlotPanel& panel) {
  std::vector<std::string> colors;
  std::size_t next = 0;
  for (const PlotCurve& curve : panel.curves)
    colors.push_back(curve.color.empty() ? palette_color(next++) : curve.color);
  return colors;
}

std::string line_attributes(const PlotCurve& curve, const std::string& color) {
  std::string attributes = "stroke=\"" + svg_escaped(color) + "\" stroke-width=\"" +
                           svg_number(curve.width) + "\" stroke-linecap=\"round\"";
  if (curve.style == CurveStyle::dashed) attributes += " stroke-dasharray=\"6 4\"";
  if (curve.style == CurveStyle::dotted) attributes += " stroke-dasharray=\"0.1 3.6\"";
  return attributes;
}

std::string path_data(const std::vector<PageChain>& chains) {
  std::string data;
  for (const PageChain& chain : chains)
    for (std::size_t i = 0; i < chain.size(); ++i) {
      data += i == 0 ? "M" : "L";
      data += svg_number(chain[i].x) + " " + svg_number(chain[i].y);
      if (chain.size() == 1) data += "h0";
    }
  return data;
}

void draw_chains(SvgCanvas& canvas, const PlotCurve& curve, const std::string& color,
                 const std::vector<PageChain>& chains) {
  if (has_line(curve) && !chains.empty())
    canvas.path(path_data(chains), line_attributes(curve, color));
  if (has_points(curve))
    for (const PageChain& chain : chains)
      for (const PagePoint& point : chain)
        canvas.circle(
            point.x, point.y, 2.4,
            "fill=\"" + svg_escaped(color) + "\" stroke=\"#ffffff\" stroke-width=\"0.5\"");
}

void place_legend(PreparedPanel& prepared, const PageBox& box,
                  const std::vector<std::vector<PageChain>>& chains) {
  double longest = 0.0;
  int rows = 0;
  for (const PlotCurve& curve : prepared.panel->curves)
    if (!curve.name.empty()) {
      longest = std::max(longest, text_width(curve.name, font_size));
      ++rows;
    }
  if (rows == 0) return;
  prepared.legend_width = 2.0 * padding + sample_width + 6.0 + longest;
  prepared.legend_height = 2.0 * padding + rows * row_height - 5.0;
  const bool fits =
      prepared.legend_width < 0.6 * box.width && prepared.legend_height < 0.6 * box.height;
  for (const int corner : {1, 0, 3, 2})
    if (fits && prepared.panel->kind == PlotPanelKind::cartesian && prepared.legend_corner < 0 &&
        hidden_length(chains, legend_box(prepared, box, corner)) == 0)
      prepared.legend_corner = corner;
  if (prepared.legend_corner < 0) prepared.right += 12.0 + prepared.legend_width;
}

void draw_legend(SvgCanvas& canvas, const PreparedPanel& prepared, const PageBox& box) {
  if (prepared.legend_width == 0.0) return;
  const PageBox place = legend_box(prepared, box, prepared.legend_corner);
  if (prepared.legend_corner >= 0)
    canvas.rectangle(place.x, place.y, place.width, place.height,
                     "rx=\"3\" fill=\"#ffffff\" fill-opacity=\"0.9\" stroke=\"#d0d0d0\" "
                     "stroke-width=\"0.6\"");
  const std::vector<std::string> colors = curve_colors(*prepared.panel);
  double y = place.y + padding + 5.5;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const PlotCurve& curve = prepared.panel->curves[i];
    if (curve.name.empty()) continue;
    const double x0 = place.x + padding, x1 = x0 + sample_width;
    if (!curve.low.empty())
      canvas.rectangle(x0, y - 4.0, sample_width, 8.0,
                       "fill=\"" + svg_escaped(colors[i]) + "\" fill-opacity=\"0.18\"");
    if (has_line(curve))
      canvas.path(path_data({{{x0, y}, {x1, y}}}), line_attributes(curve, colors[i]));
    if (has_points(curve))
      canvas.circle(0.5 * (x0 + x1), y, 2.4, "fill=\"" + svg_escaped(colors[i]) + "\"");
    if (!curve.error.empty())
      canvas.line(0.5 * (x0 + x1), y - 5.0, 0.5 * (x0 + x1), y + 5.0, colors[i], 0.9);
    canvas.text(x1 + 6.0, y + 3.7, curve.name, {.size = font_size});
    y += row_height;
  }
}

}  // namespace lamina
