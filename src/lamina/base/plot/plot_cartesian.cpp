// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lamina/base/plot/internal/plot_panel.h"

namespace lamina {
namespace {

constexpr double tick_size = 10.5, label_size = 12.0;

/// Where the values of a panel are on the page.
struct Placement {
  const PreparedPanel& prepared;
  const PageBox& data;

  [[nodiscard]] double x(double value) const {
    return data.x + prepared.x.position(value) * data.width;
  }
  [[nodiscard]] double y(double value) const {
    return data.bottom() - prepared.y.position(value) * data.height;
  }
  /// Keeps numbers that lie far outside within what viewers can draw.
  [[nodiscard]] PagePoint point(double x_value, double y_value) const {
    return {std::clamp(x(x_value), data.x - 1e4, data.right() + 1e4),
            std::clamp(y(y_value), data.y - 1e4, data.bottom() + 1e4)};
  }
};

std::vector<PageChain> chains_of(const PlotCurve& curve, const std::vector<double>& y,
                                 const Placement& place) {
  std::vector<PageChain> chains;
  bool is_broken = true;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (!std::isfinite(place.x(curve.x[i])) || !std::isfinite(place.y(y[i]))) {
      is_broken = true;
      continue;
    }
    if (is_broken) chains.emplace_back();
    is_broken = false;
    chains.back().push_back(place.point(curve.x[i], y[i]));
  }
  return chains;
}

void draw_band(SvgCanvas& canvas, const PlotCurve& curve, const std::string& color,
               const Placement& place) {
  if (curve.low.empty()) return;
  // On a logarithmic axis an edge at or below zero stands at the bottom.
  const auto at_least_bottom = [&](double value) {
    return std::isfinite(place.y(value)) || std::isnan(value) ? value : place.prepared.y.low;
  };
  PageChain outline;
  for (std::size_t i = 0; i < curve.x.size(); ++i)
    if (std::isfinite(place.x(curve.x[i])) && std::isfinite(curve.low[i] + curve.high[i]))
      outline.push_back(place.point(curve.x[i], at_least_bottom(curve.high[i])));
  for (std::size_t i = curve.x.size(); i-- > 0;)
    if (std::isfinite(place.x(curve.x[i])) && std::isfinite(curve.low[i] + curve.high[i]))
      outline.push_back(place.point(curve.x[i], at_least_bottom(curve.low[i])));
  if (outline.size() < 4) return;
  canvas.path(path_data({outline}) + "Z",
              "fill=\"" + svg_escaped(color) + "\" fill-opacity=\"0.18\"");
}

void draw_error_bars(SvgCanvas& canvas, const PlotCurve& curve, const std::string& color,
                     const Placement& place) {
  for (std::size_t i = 0; i < curve.error.size(); ++i) {
    const double high = curve.y[i] + curve.error[i];
    double low = curve.y[i] - curve.error[i];
    if (!std::isfinite(place.y(low)) && std::isfinite(low)) low = place.prepared.y.low;
    if (!std::isfinite(place.x(curve.x[i])) || !std::isfinite(place.y(high)) ||
        !std::isfinite(place.y(low)))
      continue;
    const PagePoint top = place.point(curve.x[i], high), end = place.point(curve.x[i], low);
    canvas.line(top.x, top.y, end.x, end.y, svg_escaped(color), 0.9);
    for (const PagePoint& cap : {top, end})
      canvas.line(cap.x - 2.2, cap.y, cap.x + 2.2, cap.y, svg_escaped(color), 0.9);
  }
}

double width_of(const AxisTick& tick) {
  return text_width(tick.label, tick_size) + text_width(tick.exponent, 0.74 * tick_size);
}

void draw_grid_and_ticks(SvgCanvas& canvas, const Placement& place) {
  const PageBox& data = place.data;
  const auto draw = [&](bool is_major) {
    const char* color = is_major ? "#dcdcdc" : "#f0f0f0";
    for (const AxisTick& tick : place.prepared.x_ticks)
      if (tick.is_major == is_major)
        canvas.line(place.x(tick.value), data.y, place.x(tick.value), data.bottom(), color, 0.6);
    for (const AxisTick& tick : place.prepared.y_ticks)
      if (tick.is_major == is_major)
        canvas.line(data.x, place.y(tick.value), data.right(), place.y(tick.value), color, 0.6);
  };
  draw(false);
  draw(true);
}

void draw_frame(SvgCanvas& canvas, const Placement& place) {
  const PageBox& data = place.data;
  constexpr const char* ink = "#333333";
  canvas.rectangle(data.x, data.y, data.width, data.height,
                   "stroke=\"#333333\" stroke-width=\"0.9\"");
  for (const AxisTick& tick : place.prepared.x_ticks) {
    const double x = place.x(tick.value), length = tick.is_major ? 4.5 : 2.5;
    canvas.line(x, data.bottom(), x, data.bottom() - length, ink, 0.8);
    canvas.text(x, data.bottom() + 15.0, tick.label,
                {.size = tick_size, .anchor = TextAnchor::middle}, tick.exponent);
  }
  for (const AxisTick& tick : place.prepared.y_ticks) {
    const double y = place.y(tick.value), length = tick.is_major ? 4.5 : 2.5;
    canvas.line(data.x, y, data.x + length, y, ink, 0.8);
    canvas.text(data.x - 6.0, y + 3.8, tick.label, {.size = tick_size, .anchor = TextAnchor::end},
                tick.exponent);
  }
}

}  // namespace

PreparedPanel prepare_cartesian(const PlotPanel& panel, const PageBox& data) {
  PreparedPanel prepared{.panel = &panel};
  ValueRange x, y;
  for (const PlotCurve& curve : panel.curves)
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      x.add(curve.x[i], panel.x.scale);
      y.add(curve.y[i], panel.y.scale);
      if (!curve.error.empty()) {
        y.add(curve.y[i] + curve.error[i], panel.y.scale);
        // The lower end of a bar may reach towards zero; a logarithmic axis need not follow it.
        if (panel.y.scale == AxisScale::linear) y.add(curve.y[i] - curve.error[i], panel.y.scale);
      }
      if (!curve.low.empty()) {
        y.add(curve.high[i], panel.y.scale);
        if (panel.y.scale == AxisScale::linear) y.add(curve.low[i], panel.y.scale);
      }
    }
  prepared.x = make_span(panel.x, x);
  const auto is_line = [](const PlotCurve& curve) {
    return curve.style != CurveStyle::points && curve.style != CurveStyle::line_and_points;
  };
  if (!x.is_empty && x.low < x.high && std::ranges::all_of(panel.curves, is_line)) {
    prepared.x.low = panel.x.low.value_or(x.low);  // lines may end at the frame, points not
    prepared.x.high = panel.x.high.value_or(x.high);
  }
  prepared.y = make_span(panel.y, y);
  prepared.x_ticks = make_ticks(prepared.x, data.width, 58.0);
  prepared.y_ticks =
      make_ticks(prepared.y, data.height, panel.y.scale == AxisScale::linear ? 36.0 : 25.0);

  double widest = 0.0;
  for (const AxisTick& tick : prepared.y_ticks) widest = std::max(widest, width_of(tick));
  prepared.left = 6.0 + widest + (panel.y.label.empty() ? 6.0 : 8.0 + label_size + 6.0);
  prepared.bottom = 20.0 + (panel.x.label.empty() ? 0.0 : label_size + 8.0);
  prepared.top = panel.title.empty() ? 8.0 : 26.0;
  prepared.right = 14.0;  // half a tick label
  std::vector<std::vector<PageChain>> chains;
  const Placement place{prepared, data};
  for (const PlotCurve& curve : panel.curves) {
    chains.push_back(chains_of(curve, curve.y, place));
    if (!curve.low.empty()) {
      chains.push_back(chains_of(curve, curve.low, place));
      chains.push_back(chains_of(curve, curve.high, place));
    }
  }
  place_legend(prepared, data, chains);
  return prepared;
}

void draw_cartesian(SvgCanvas& canvas, const PreparedPanel& prepared, const PageBox& data) {
  const PlotPanel& panel = *prepared.panel;
  const Placement place{prepared, data};
  canvas.text(data.x, data.y - 9.0, panel.title, {.size = 12.5, .is_bold = true});
  draw_grid_and_ticks(canvas, place);
  const std::vector<std::string> colors = curve_colors(panel);
  canvas.begin_clip(data.x, data.y, data.width, data.height);
  for (std::size_t i = 0; i < colors.size(); ++i)
    draw_band(canvas, panel.curves[i], colors[i], place);
  for (std::size_t i = 0; i < colors.size(); ++i) {
    draw_error_bars(canvas, panel.curves[i], colors[i], place);
    draw_chains(canvas, panel.curves[i], colors[i],
                chains_of(panel.curves[i], panel.curves[i].y, place));
  }
  canvas.end_group();
  draw_frame(canvas, place);
  canvas.text(data.x + 0.5 * data.width, data.bottom() + 20.0 + label_size + 2.0, panel.x.label,
              {.size = label_size, .anchor = TextAnchor::middle});
  canvas.text(data.x - prepared.left + label_size + 4.0, data.y + 0.5 * data.height, panel.y.label,
              {.size = label_size, .anchor = TextAnchor::middle, .turn = -90.0});
  draw_legend(canvas, prepared, data);
}

}  // namespace lamina
