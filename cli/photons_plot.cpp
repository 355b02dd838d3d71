// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/plot/plot.h"
#include "photons_report.h"

namespace lamina::cli {
namespace {

/// The bands of a run as the plot's colours know them.
BandSet band_set(const std::vector<std::string>& bands) {
  std::vector<double> wavelengths;
  for (const std::string& band : bands)
    if (band.size() > 1) wavelengths.push_back(rounded_number(band));
  return wavelengths.empty() ? BandSet::rgb() : BandSet(wavelengths);
}

void add_curves(const PhotonRun& run, const std::vector<double>& x,
                TwoSided MonteCarloResult::*member, PlotPanel& panel) {
  const BandSet bands = band_set(run.bands);
  for (std::size_t band = 0; band < run.counts.size(); ++band) {
    const MonteCarloResult result = summarize(run.counts[band]);
    const bool is_named = !run.bands[band].empty();
    const std::string name = is_named ? band_label(bands, band) : "";
    const std::string color = is_named ? band_color(bands, band) : "";
    const auto add = [&](const std::vector<Estimate>& estimates, const std::string& what,
                         CurveStyle style) {
      PlotCurve curve = {.name = name.empty() ? what : name + " " + what, .x = x, .y = {}};
      for (const Estimate& e : estimates) {
        curve.y.push_back(e.value);
        curve.low.push_back(std::max(0.0, e.value - e.standard_error));
        curve.high.push_back(e.value + e.standard_error);
      }
      // The last ring, and the last time, hold all that lies beyond: no density.
      if (member != &MonteCarloResult::angular && curve.y.size() > 1) {
        curve.x.pop_back(), curve.y.pop_back(), curve.low.pop_back(), curve.high.pop_back();
      }
      curve.color = color;
      curve.style = style;
      if (std::ranges::any_of(curve.y, [](double y) { return y > 0.0; }))
        panel.curves.push_back(std::move(curve));
    };
    add((result.*member).reflection, "reflected", CurveStyle::line);
    add((result.*member).transmission, "transmitted", CurveStyle::dashed);
  }
}

}  // namespace

void plot_photons(const PhotonRun& run, const std::string& file) {
  const PhotonTallies& t = run.counts[0].tallies;
  if (t.r.count == 0 && t.angles == 0 && t.time.count == 0)
    throw InvalidInput("--plot: needs --tally r, angle or time, but none is given");
  Plot plot;
  plot.title = title_of(run);
  plot.caption = fmt::format("Photon Monte Carlo, {} photons per band; shaded: one standard error",
                             run.counts[0].photons);
  if (t.r.count > 0) {
    PlotPanel& panel = plot.panels.emplace_back();
    panel.x = {.label = "r [mm]"};
    panel.y = {.label = "flux density [1/mm²]", .scale = AxisScale::logarithmic};
    std::vector<double> x;
    for (int i = 0; i < t.r.count; ++i) x.push_back((i + 0.5) * t.r.width);
    add_curves(run, x, &MonteCarloResult::radial, panel);
  }
  if (t.angles > 0) {
    PlotPanel& panel = plot.panels.emplace_back();
    panel.x = {.label = "angle from the normal [degrees]", .low = 0.0, .high = 90.0};
    panel.y = {.label = "intensity [1/sr]"};
    std::vector<double> x;
    for (int i = 0; i < t.angles; ++i) x.push_back((i + 0.5) * 90.0 / t.angles);
    add_curves(run, x, &MonteCarloResult::angular, panel);
  }
  if (t.time.count > 0) {
    PlotPanel& panel = plot.panels.emplace_back();
    panel.x = {.label = "time of flight [ps]"};
    panel.y = {.label = "flux [1/ps]", .scale = AxisScale::logarithmic};
    std::vector<double> x;
    for (int i = 0; i < t.time.count; ++i) x.push_back((i + 0.5) * t.time.width);
    add_curves(run, x, &MonteCarloResult::time, panel);
  }
  save_svg(plot, file);
}

}  // namespace lamina::cli
