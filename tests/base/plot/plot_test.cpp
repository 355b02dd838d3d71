// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/plot/plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>

#include "base/image/scratch_folder.h"
#include "lamina/base/core/error.h"
#include "lamina/base/plot/internal/plot_axis.h"
#include "lamina/base/plot/internal/svg_canvas.h"

namespace lamina {
namespace {

int count(const std::string& text, const std::string& part) {
  int found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

PlotCurve decay(const std::string& name, double rate) {
  PlotCurve curve{.name = name};
  for (int i = 0; i < 50; ++i) {
    curve.x.push_back(0.1 * (i + 1));
    curve.y.push_back(std::exp(-rate * curve.x.back()));
  }
  return curve;
}

Plot two_panels() {
  Plot plot{.title = "A & B", .caption = "<source>"};
  for (const PlotPanelKind kind : {PlotPanelKind::cartesian, PlotPanelKind::polar}) {
    PlotPanel& panel = plot.panels.emplace_back();
    panel.kind = kind;
    panel.x = {.label = "r [mm]"};
    panel.y = {.label = "R(r) [mm⁻²]", .scale = AxisScale::logarithmic};
    panel.curves = {decay("first", 1.0), decay("second", 2.0)};
  }
  return plot;
}

/// Every element that is opened is closed, in order.
bool is_well_formed(const std::string& svg) {
  std::vector<std::string> open;
  for (std::size_t at = svg.find('<'); at != std::string::npos; at = svg.find('<', at + 1)) {
    const std::size_t end = svg.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = svg.substr(at + 1, end - at - 1);
    if (tag[0] == '?' || tag.back() == '/') continue;
    const std::string name = tag.substr(tag[0] == '/' ? 1 : 0, tag.find(' '));
    if (tag[0] != '/') {
      open.push_back(name);
    } else {
      if (open.empty() || open.back() != name) return false;
      open.pop_back();
    }
  }
  return open.empty();
}

TEST(Plot, HasEqualBytesForEqualPlots) {
  const std::string svg = format_svg(two_panels());
  EXPECT_EQ(svg, format_svg(two_panels()));
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_EQ(count(svg, ">first<"), 2);
  EXPECT_EQ(count(svg, "A &amp; B"), 1);
  EXPECT_EQ(count(svg, "&lt;source&gt;"), 1);
}

TEST(Plot, DrawsNothingThatIsNotANumber) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double inf = std::numeric_limits<double>::infinity();
  for (const PlotPanelKind kind : {PlotPanelKind::cartesian, PlotPanelKind::polar})
    for (const AxisScale scale : {AxisScale::linear, AxisScale::logarithmic}) {
      Plot plot;
      PlotPanel& panel = plot.panels.emplace_back();
      panel.kind = kind;
      panel.x.scale = panel.y.scale = scale;
      panel.curves = {{.name = "odd",
                       .x = {-1.0, 0.0, 1.0, nan, 2.0, 1e300, inf},
                       .y = {1.0, inf, nan, 1.0, 1e-300, 1e300, -inf}},
                      {.name = "nothing"},
                      {.name = "bars", .x = {1.0, 2.0}, .y = {1.0, 2.0}, .error = {nan, inf}},
                      {.name = "band",
                       .x = {1.0, 2.0},
                       .y = {1.0, 2.0},
                       .low = {0.0, -inf},
                       .high = {nan, 3.0}},
                      {.name = "flat", .x = {1.0, 1.0}, .y = {2.0, 2.0}}};
      const std::string svg = format_svg(plot);
      EXPECT_TRUE(is_well_formed(svg));
      EXPECT_EQ(count(svg, "nan"), 0);
      EXPECT_EQ(count(svg, "inf"), 0);
    }
  EXPECT_TRUE(is_well_formed(format_svg({})));
}

TEST(Plot, BreaksALineWhereThereIsNoValue) {
  Plot plot;
  PlotPanel& panel = plot.panels.emplace_back();
  panel.curves = {{.x = {0.0, 1.0, 2.0, 3.0, 4.0},
                   .y = {1.0, 2.0, std::nan(""), 3.0, 4.0},
                   .color = "#123456"}};
  const std::string svg = format_svg(plot);
  const std::size_t end = svg.find("stroke=\"#123456\""), start = svg.rfind("<path", end);
  EXPECT_EQ(count(svg.substr(start, end - start), "M"), 2);
}

TEST(Plot, RefusesArraysOfDifferentLengthsAndAxesThatAreNoRange) {
  Plot plot;
  PlotPanel& panel = plot.panels.emplace_back();
  panel.curves = {{.name = "short", .x = {1.0, 2.0}, .y = {1.0}}};
  try {
    (void)format_svg(plot);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "curve \"short\": y must have as many values as x, 2, but has 1");
  }
  panel.curves = {{.x = {1.0}, .y = {1.0}, .error = {1.0, 2.0}}};
  EXPECT_THROW((void)format_svg(plot), InvalidInput);
  panel.curves = {{.x = {1.0}, .y = {1.0}, .low = {1.0}}};
  EXPECT_THROW((void)format_svg(plot), InvalidInput);
  panel.curves = {decay("fine", 1.0)};
  panel.x = {.low = 2.0, .high = 1.0};
  EXPECT_THROW((void)format_svg(plot), InvalidInput);
  panel.x = {.scale = AxisScale::logarithmic, .low = 0.0};
  EXPECT_THROW((void)format_svg(plot), InvalidInput);
  panel.x = {};
  plot.panel_width = std::nan("");
  EXPECT_THROW((void)format_svg(plot), InvalidInput);
}

std::vector<std::string> labels(const AxisSpan& span, double pixels) {
  std::vector<std::string> found;
  for (const AxisTick& tick : make_ticks(span, pixels, 50.0)) {
    if (!tick.label.empty())
      found.push_back(tick.label + (tick.exponent.empty() ? "" : "^" + tick.exponent));
  }
  return found;
}

TEST(PlotAxis, HasRoundTicks) {
  using Labels = std::vector<std::string>;
  EXPECT_EQ(labels({.low = 0.0, .high = 1.0}, 250.0),
            (Labels{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(labels({.low = -30.0, .high = 30.0}, 250.0), (Labels{"−20", "0", "20"}));
  EXPECT_EQ(labels({.low = 400.0, .high = 700.0}, 350.0),
            (Labels{"400", "450", "500", "550", "600", "650", "700"}));
  const AxisScale log = AxisScale::logarithmic;
  EXPECT_EQ(labels({.scale = log, .low = 0.1, .high = 100.0}, 300.0),
            (Labels{"0.1", "1", "10", "100"}));
  EXPECT_EQ(labels({.scale = log, .low = 1e-6, .high = 1e-2}, 300.0),
            (Labels{"10^−6", "10^−5", "10^−4", "10^−3", "10^−2"}));
  EXPECT_EQ(labels({.scale = log, .low = 0.3, .high = 3.0}, 300.0), (Labels{"0.5", "1", "2"}));
  EXPECT_EQ(labels({.scale = log, .low = 1e-12, .high = 1.0}, 200.0),
            (Labels{"10^−12", "10^−9", "10^−6", "10^−3", "10^0"}));
}

TEST(PlotAxis, NeverHasTooManyTicks) {
  for (const AxisScale scale : {AxisScale::linear, AxisScale::logarithmic})
    for (const double low : {1e-300, 1e-9, 1.0, 1e9})
      for (const double ratio : {1.0 + 1e-9, 1.1, 10.0, 1e6, 1e280})
        EXPECT_LE(make_ticks({.scale = scale, .low = low, .high = low * ratio}, 300.0, 30.0).size(),
                  310u)
            << low << " " << ratio;
}

TEST(Plot, BreaksALongCaptionAtSpaces) {
  Plot plot = two_panels();
  const std::string short_svg = format_svg(plot);
  plot.caption = "word";
  for (int i = 0; i < 200; ++i) plot.caption += " word";
  const std::string svg = format_svg(plot);
  EXPECT_GE(count(svg, ">word word"), 3);
  const auto width = [](const std::string& text) {
    const std::size_t start = text.find("width=");
    return text.substr(start, text.find(' ', start) - start);
  };
  EXPECT_EQ(width(svg), width(short_svg));
}

TEST(Plot, BandsHaveTheirOwnColors) {
  EXPECT_EQ(band_label(BandSet::rgb(), 0), "R");
  EXPECT_EQ(band_label(default_spectral_bands(), 3), "505 nm");
  std::vector<std::string> colors;
  for (std::size_t b = 0; b < 8; ++b) colors.push_back(band_color(default_spectral_bands(), b));
  for (std::size_t b = 0; b < 3; ++b) colors.push_back(band_color(BandSet::rgb(), b));
  std::ranges::sort(colors);
  EXPECT_EQ(std::ranges::adjacent_find(colors), colors.end());
  EXPECT_EQ(band_color(BandSet({200.0, 3000.0}), 1).size(), 7u);
}

using PlotFile = ScratchFolder;

TEST_F(PlotFile, HoldsTheText) {
  save_svg(two_panels(), path("a.svg"));
  std::ifstream stream(path("a.svg"));
  const std::string text((std::istreambuf_iterator<char>(stream)), {});
  EXPECT_EQ(text, format_svg(two_panels()));
  EXPECT_THROW(save_svg(two_panels(), path("missing/a.svg")), WriteError);
}

}  // namespace
}  // namespace lamina
