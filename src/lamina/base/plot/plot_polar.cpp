// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/plot/internal/plot_panel.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double polar_tick_size = 10.0, polar_label_size = 12.0;

/// The disc, or its upper half, on the page; room for the labels of the angles is inside `data`.
struct Disc {
  double x, y, radius;

  [[nodiscard]] PagePoint at(double angle, double fraction) const {
    return {x + radius * fraction * std::sin(angle), y - radius * fraction * std::cos(angle)};
  }
};

Disc disc_of(const PreparedPanel& prepared, const PageBox& data) {
  constexpr double room = 20.0;
  if (prepared.has_lower_half) {
    const double radius = 0.5 * std::min(data.width, data.height) - room;
    return {data.x + 0.5 * data.width, data.y + 0.5 * data.height, radius};
  }
  const double radius = std::min(0.5 * data.width, data.height - room) - room;
  return {data.x + 0.5 * data.width, data.bottom() - room, radius};
}

std::vector<PageChain> chains_of(const PlotCurve& curve, const PreparedPanel& prepared,
                                 const Disc& disc) {
  std::vector<PageChain> chains;
  bool is_broken = true;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const double fraction = prepared.y.position(curve.y[i]);
    if (!std::isfinite(fraction) || !std::isfinite(curve.x[i])) {
      is_broken = true;
      continue;
    }
    if (is_broken) chains.emplace_back();
    is_broken = false;
    chains.back().push_back(disc.at(curve.x[i], std::clamp(fraction, 0.0, 1.0)));
  }
  return chains;
}

void draw_band(SvgCanvas& canvas, const PlotCurve& curve, const std::string& color,
               const PreparedPanel& prepared, const Disc& disc) {
  if (curve.low.empty()) return;
  PageChain outline;
  const auto add = [&](std::size_t i, double value) {
    const double fraction = prepared.y.position(value);
    if (std::isfinite(curve.x[i]) && !std::isnan(fraction))
      outline.push_back(disc.at(curve.x[i], std::clamp(fraction, 0.0, 1.0)));
  };
  for (std::size_t i = 0; i < curve.x.size(); ++i) add(i, curve.high[i]);
  for (std::size_t i = curve.x.size(); i-- > 0;) add(i, curve.low[i]);
  if (outline.size() >= 4)
    canvas.path(path_data({outline}) + "Z",
                "fill=\"" + svg_escaped(color) + "\" fill-opacity=\"0.18\"");
}

/// Part of a circle from one angle to another, clockwise from the normal.
std::string arc(const Disc& disc, double fraction, double from, double to) {
  const PagePoint start = disc.at(from, fraction), end = disc.at(to, fraction);
  const std::string radius = svg_number(disc.radius * fraction);
  return "M" + svg_number(start.x) + " " + svg_number(start.y) + "A" + radius + " " + radius +
         " 0 0 1 " + svg_number(end.x) + " " + svg_number(end.y);
}

void draw_ring(SvgCanvas& canvas, const PreparedPanel& prepared, const Disc& disc, double fraction,
               const std::string& attributes) {
  canvas.path(arc(disc, fraction, -0.5 * pi, 0.5 * pi), attributes);
  if (prepared.has_lower_half) canvas.path(arc(disc, fraction, 0.5 * pi, 1.5 * pi), attributes);
}

void draw_rings_and_spokes(SvgCanvas& canvas, const PreparedPanel& prepared, const Disc& disc) {
  for (const AxisTick& tick : prepared.y_ticks) {
    const double fraction = prepared.y.position(tick.value);
    if (!tick.is_major || fraction < 0.02 || fraction > 1.001) continue;
    draw_ring(canvas, prepared, disc, fraction, "stroke=\"#dcdcdc\" stroke-width=\"0.6\"");
  }
  const int last = prepared.has_lower_half ? 180 : 90;
  for (int degrees = -last + (prepared.has_lower_half ? 15 : 0); degrees <= last; degrees += 15) {
    const double angle = degrees * pi / 180.0;
    const PagePoint end = disc.at(angle, 1.0);
    const bool is_major = degrees % 30 == 0;
    canvas.line(disc.x, disc.y, end.x, end.y, is_major ? "#dcdcdc" : "#f0f0f0", 0.6);
    if (!is_major) continue;
    const PagePoint label = disc.at(angle, 1.0 + 11.0 / disc.radius);
    const int from_normal = std::abs(degrees) > 90 ? 180 - std::abs(degrees) : std::abs(degrees);
    const TextAnchor anchor = std::abs(std::sin(angle)) < 0.1 ? TextAnchor::middle
                              : degrees > 0                   ? TextAnchor::start
                                                              : TextAnchor::end;
    const bool is_middle = anchor == TextAnchor::middle || std::abs(degrees) == 90;
    const double shift = is_middle ? 0.0 : degrees > 0 ? -4.0 : 4.0;
    canvas.text(label.x + shift, label.y + 3.6, std::to_string(from_normal) + "°",
                {.size = polar_tick_size, .anchor = anchor, .color = "#555555"});
  }
}

/// Labels of the rings, along the surface on the right, below it if the lower half is free.
void draw_ring_labels(SvgCanvas& canvas, const PreparedPanel& prepared, const Disc& disc) {
  const double y = disc.y + (prepared.has_lower_half ? -4.0 : 14.0);
  for (const AxisTick& tick : prepared.y_ticks) {
    const double fraction = prepared.y.position(tick.value);
    if (tick.label.empty() || fraction > 1.001 || fraction < 0.0) continue;
    if (prepared.has_lower_half && fraction < 0.1) continue;
    canvas.text(disc.x + fraction * disc.radius, y, tick.label,
                {.size = polar_tick_size,
                 .anchor = TextAnchor::middle,
                 .color = "#555555",
                 .has_halo = true},
                tick.exponent);
  }
}

/// Where the light comes from: an arrow to the middle.
void draw_arrow(SvgCanvas& canvas, const Disc& disc, double angle) {
  const PagePoint tail = disc.at(angle, 1.0), head = disc.at(angle, 10.0 / disc.radius);
  const double dx = std::sin(angle), dy = -std::cos(angle);
  const PagePoint neck{head.x + 9.0 * dx, head.y + 9.0 * dy};
  canvas.line(tail.x, tail.y, neck.x, neck.y, "#333333", 1.4);
  canvas.path(path_data({{{head.x, head.y},
                          {neck.x - 3.4 * dy, neck.y + 3.4 * dx},
                          {neck.x + 3.4 * dy, neck.y - 3.4 * dx}}}) +
                  "Z",
              "fill=\"#333333\"");
}

}  // namespace

PreparedPanel prepare_polar(const PlotPanel& panel, const PageBox& data) {
  PreparedPanel prepared{.panel = &panel};
  ValueRange radius;
  for (const PlotCurve& curve : panel.curves)
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      radius.add(curve.y[i], panel.y.scale);
      if (!curve.high.empty()) radius.add(curve.high[i], panel.y.scale);
      if (std::abs(curve.x[i]) > 0.5 * pi + 1e-9) prepared.has_lower_half = true;
    }
  PlotAxis axis = panel.y;
  if (axis.scale == AxisScale::linear && !axis.low) axis.low = 0.0;
  if (radius.is_empty || radius.high <= 0.0) radius = {.low = 0.1, .high = 1.0, .is_empty = false};
  prepared.y = make_span(axis, radius);
  const Disc disc = disc_of(prepared, data);
  prepared.y_ticks = make_ticks(prepared.y, disc.radius, 34.0);
  prepared.left = prepared.right = 14.0;
  prepared.top = panel.title.empty() ? 8.0 : 30.0;
  prepared.bottom = panel.y.label.empty() ? 8.0 : polar_label_size + 12.0;
  place_legend(prepared, data, {});
  return prepared;
}

void draw_polar(SvgCanvas& canvas, const PreparedPanel& prepared, const PageBox& data) {
  const PlotPanel& panel = *prepared.panel;
  const Disc disc = disc_of(prepared, data);
  canvas.text(data.x, data.y - 9.0, panel.title, {.size = 12.5, .is_bold = true});
  draw_rings_and_spokes(canvas, prepared, disc);
  draw_ring(canvas, prepared, disc, 1.0, "stroke=\"#333333\" stroke-width=\"0.9\"");
  canvas.line(disc.x - disc.radius - 6.0, disc.y, disc.x + disc.radius + 6.0, disc.y, "#333333",
              1.4);  // the surface
  if (panel.arrow_angle) draw_arrow(canvas, disc, *panel.arrow_angle);
  const std::vector<std::string> colors = curve_colors(panel);
  for (std::size_t i = 0; i < colors.size(); ++i)
    draw_band(canvas, panel.curves[i], colors[i], prepared, disc);
  for (std::size_t i = 0; i < colors.size(); ++i)
    draw_chains(canvas, panel.curves[i], colors[i], chains_of(panel.curves[i], prepared, disc));
  draw_ring_labels(canvas, prepared, disc);
  const double label_y = prepared.has_lower_half ? data.bottom() + polar_label_size + 2.0
                                                 : disc.y + 22.0 + polar_label_size;
  canvas.text(disc.x, label_y, panel.y.label,
              {.size = polar_label_size, .anchor = TextAnchor::middle});
  draw_legend(canvas, prepared, data);
}

}  // namespace lamina
