// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "bsdf_options.h"
#include "degrees.h"
#include "lamina/base/core/error.h"
#include "lamina/base/plot/plot.h"
#include "lamina/layers/materials/material.h"
#include "material_bands.h"

namespace lamina::cli {
namespace {

using Estimates = std::vector<Estimate>;

constexpr auto brdf = &TwoSided::reflection;
constexpr auto btdf = &TwoSided::transmission;
using SideOf = Estimates TwoSided::*;

/// Cells of equal solid angle, folded about the plane of incidence: [cosine][azimuth] with the
/// azimuth from forward, in [0, 180].
struct Cells {
  std::size_t rows, columns;
  [[nodiscard]] double theta_deg(std::size_t row) const {  // of the middle of the solid angle
    return std::acos(1.0 - (static_cast<double>(row) + 0.5) / static_cast<double>(rows)) / degree;
  }
  [[nodiscard]] double phi_deg(std::size_t column) const {
    return (static_cast<double>(column) + 0.5) * 180.0 / static_cast<double>(columns);
  }
};

/// Photons tally the azimuth of travel over the full circle, and rows from the horizon up. The two
/// halves of a mirror-symmetric cell are independent.
Estimates folded(const Estimates& cells, std::size_t planes, const Cells& to) {
  Estimates out;
  const std::size_t all = 2 * to.columns;
  for (std::size_t plane = 0; plane < planes; ++plane)
    for (std::size_t i = 0; i < to.rows; ++i)
      for (std::size_t j = 0; j < to.columns; ++j) {
        const Estimate* row = &cells[(plane * to.rows + to.rows - 1 - i) * all];
        const Estimate& a = row[j];
        const Estimate& b = row[all - 1 - j];
        out.push_back({.value = 0.5 * (a.value + b.value),
                       .standard_error = 0.5 * std::hypot(a.standard_error, b.standard_error)});
      }
  return out;
}

struct BandResult {
  MonteCarloResult totals;
  TwoSided bsdf;      ///< [cell]
  TwoSided by_order;  ///< [order][cell]
};

BandResult trace(const LayerStack& stack, const MonteCarloOptions& options, const Cells& cells) {
  BandResult band{.totals = trace_photons(stack, options)};
  for (const SideOf side : {brdf, btdf}) {
    band.bsdf.*side = folded(band.totals.bsdf.*side, 1, cells);
    if (options.tallies.orders)
      band.by_order.*side = folded(band.totals.bsdf_by_order.*side, photon_orders, cells);
  }
  return band;
}

/// [plane][theta][phi][band]; without planes [theta][phi][band].
JsonOutput by_cells(const std::vector<BandResult>& bands, TwoSided BandResult::*member, SideOf side,
                    double Estimate::*part, std::size_t planes, const Cells& cells) {
  JsonOutput all = JsonOutput::array();
  for (std::size_t plane = 0; plane < planes; ++plane) {
    JsonOutput rows = JsonOutput::array();
    for (std::size_t i = 0; i < cells.rows; ++i) {
      JsonOutput& row = rows.emplace_back(JsonOutput::array());
      for (std::size_t j = 0; j < cells.columns; ++j) {
        JsonOutput& cell = row.emplace_back(JsonOutput::array());
        for (const BandResult& band : bands)
          cell.push_back((band.*member.*side)[(plane * cells.rows + i) * cells.columns + j].*part);
      }
    }
    all.push_back(std::move(rows));
  }
  return member == &BandResult::bsdf ? all.front() : all;
}

JsonOutput totals_json(const std::vector<BandResult>& bands, double Estimate::*part) {
  JsonOutput json;
  const auto add = [&](const char* name, Estimate MonteCarloResult::*member) {
    for (const BandResult& band : bands) json[name].push_back(band.totals.*member.*part);
  };
  add("specular_reflectance", &MonteCarloResult::specular_reflectance);
  add("diffuse_reflectance", &MonteCarloResult::diffuse_reflectance);
  add("transmittance", &MonteCarloResult::transmittance);
  add("unscattered_reflectance", &MonteCarloResult::unscattered_reflectance);
  add("unscattered_transmittance", &MonteCarloResult::unscattered_transmittance);
  add("unfinished", &MonteCarloResult::unfinished);
  return json;
}

JsonOutput to_json(const BsdfOptions& options, const Material& material, const Cells& cells,
                   const std::vector<BandResult>& bands) {
  JsonOutput json = make_result("bsdf");
  json["material"] = material.name;
  json["method"] = "monte_carlo";
  json["bands"] = bands_json(material.bands);
  json["theta_i_deg"] = options.theta_i_deg;
  for (std::size_t i = 0; i < cells.rows; ++i) json["theta_o_deg"].push_back(cells.theta_deg(i));
  for (std::size_t j = 0; j < cells.columns; ++j) json["phi_o_deg"].push_back(cells.phi_deg(j));
  for (const BandResult& band : bands) json["photons"].push_back(band.totals.photons);
  const auto add = [&](JsonOutput& to, double Estimate::*part) {
    to.update(totals_json(bands, part));
    for (const SideOf side : {brdf, btdf}) {
      const std::string name = side == brdf ? "brdf" : "btdf";
      to[name] = by_cells(bands, &BandResult::bsdf, side, part, 1, cells);
      if (options.orders)  // 0, 1 to 10, the rest
        to[name + "_by_order"] =
            by_cells(bands, &BandResult::by_order, side, part, photon_orders, cells);
    }
  };
  add(json, &Estimate::value);
  add(json["standard_error"], &Estimate::standard_error);
  return json;
}

/// Bands differ if the run was stopped.
std::string photons_text(const std::vector<BandResult>& bands) {
  std::uint64_t fewest = bands[0].totals.photons, most = fewest;
  for (const BandResult& band : bands) {
    fewest = std::min(fewest, band.totals.photons);
    most = std::max(most, band.totals.photons);
  }
  return fewest == most ? fmt::format("{} photons per band", most)
                        : fmt::format("{} to {} photons per band", fewest, most);
}

/// The mean of the two cells at the plane of incidence, towards the light or away from it.
Estimate in_plane(const Estimates& values, const Cells& cells, std::size_t row, bool is_light_side,
                  std::size_t plane = 0) {
  return values[(plane * cells.rows + row) * cells.columns +
                (is_light_side ? cells.columns - 1 : 0)];
}

std::string order_name(std::size_t order) {
  return order + 1 < photon_orders ? fmt::format("{}", order) : "more";
}

std::string to_text(const BsdfOptions& options, const Material& material, const Cells& cells,
                    const std::vector<BandResult>& bands) {
  std::string text = fmt::format(
      "{}, light from {:.4g}°, monte_carlo, {}: 1/sr beside the plane of "
      "incidence,\n< 0 on the side of the light, ± one standard error\n\n{:>8}",
      material.name, options.theta_i_deg, photons_text(bands), "theta_o");
  for (const char* side : {"brdf", "btdf"})
    for (std::size_t band = 0; band < bands.size(); ++band)
      text += fmt::format("{:>21}", fmt::format("{} {}", side, band_name(material.bands, band)));
  const auto line = [&](std::size_t row, bool is_light_side) {
    text += fmt::format("\n{:>8.3g}", (is_light_side ? -1.0 : 1.0) * cells.theta_deg(row));
    for (const SideOf side : {brdf, btdf})
      for (const BandResult& band : bands) {
        const Estimate e = in_plane(band.bsdf.*side, cells, row, is_light_side);
        text += fmt::format("{:>11.4g} ± {:<7.2g}", e.value, e.standard_error);
      }
  };
  for (std::size_t i = cells.rows; i-- > 0;) line(i, true);
  for (std::size_t i = 0; i < cells.rows; ++i) line(i, false);
  if (options.orders) {
    text += fmt::format("\n\n{:>8}", "order");
    for (const char* side : {"reflected", "transmitted"})
      for (std::size_t band = 0; band < bands.size(); ++band)
        text += fmt::format("{:>21}", fmt::format("{} {}", side, band_name(material.bands, band)));
    for (std::size_t order = 0; order < photon_orders; ++order) {
      text += fmt::format("\n{:>8}", order_name(order));
      for (const SideOf side : {brdf, btdf})
        for (const BandResult& band : bands) {
          const Estimate e = (band.totals.by_order.*side)[order];
          text += fmt::format("{:>11.5f} ± {:<7.2g}", e.value, e.standard_error);
        }
    }
  }
  return text + "\n";
}

/// Adds a curve through the plane of incidence. `values` gives the estimate of a row and side.
template <class Values>
void add_curve(PlotPanel& panel, PlotCurve curve, const Cells& cells, SideOf side,
               const Values& values) {
  const auto add = [&](std::size_t row, bool is_light_side) {
    const double theta = cells.theta_deg(row) * degree;
    const double angle = side == brdf ? theta : std::numbers::pi - theta;
    const Estimate e = values(row, is_light_side);
    curve.x.push_back(is_light_side ? -angle : angle);
    curve.y.push_back(e.value);
    curve.low.push_back(std::max(0.0, e.value - e.standard_error));
    curve.high.push_back(e.value + e.standard_error);
  };
  for (std::size_t i = cells.rows; i-- > 0;) add(i, true);
  for (std::size_t i = 0; i < cells.rows; ++i) add(i, false);
  panel.curves.push_back(std::move(curve));
}

PlotPanel make_panel(const BsdfOptions& options, const std::string& title) {
  return {.title = title,
          .kind = PlotPanelKind::polar,
          .y = {.label = "[1/sr]"},
          .arrow_angle = -options.theta_i_deg * degree};
}

/// Orders of one band as [HanrahanKrueger1993] Figure 9 shows them, later ones together.
PlotPanel order_panel(const BsdfOptions& options, const Material& material, const Cells& cells,
                      const BandResult& result, std::size_t band, SideOf side) {
  PlotPanel panel = make_panel(
      options, fmt::format("{}, {}, by order", side == brdf ? "reflected" : "transmitted",
                           band_label(material.bands, band)));
  struct Range {
    const char* name;
    std::size_t first, last;
  };
  constexpr std::array ranges = {Range{"once", 1, 1}, Range{"twice", 2, 2},
                                 Range{"3 to 10 times", 3, 10}, Range{"more often", 11, 11},
                                 Range{"all", 0, photon_orders - 1}};
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const Range& range = ranges[k];
    PlotCurve curve{.name = side == brdf ? range.name : "", .color = palette_color(k)};
    add_curve(panel, std::move(curve), cells, side, [&](std::size_t row, bool is_light_side) {
      Estimate sum;
      for (std::size_t order = range.first; order <= range.last; ++order) {
        const Estimate e = in_plane(result.by_order.*side, cells, row, is_light_side, order);
        sum.value += e.value;
        sum.standard_error = std::hypot(sum.standard_error, e.standard_error);
      }
      return sum;
    });
  }
  return panel;
}

void write_plot(const BsdfOptions& options, const Material& material, const Cells& cells,
                const std::vector<BandResult>& bands) {
  if (options.plot.empty()) return;
  Plot plot{.title = fmt::format("{}, light from {:.4g}°", material.name, options.theta_i_deg),
            .caption = fmt::format(
                "Photon Monte Carlo, {}: radiance per irradiance beside the plane "
                "of incidence; shaded: one standard error. Unscattered light is left out.",
                photons_text(bands)),
            .columns = 2};
  std::vector<SideOf> sides = {brdf};
  const auto is_lit = [](const Estimate& e) { return e.value > 0.0; };
  if (std::ranges::any_of(bands, [&](const BandResult& band) {
        return std::ranges::any_of(band.bsdf.transmission, is_lit);
      }))
    sides.push_back(btdf);
  for (const SideOf side : sides) {
    PlotPanel& panel =
        plot.panels.emplace_back(make_panel(options, side == brdf ? "reflected" : "transmitted"));
    for (std::size_t band = 0; band < bands.size(); ++band) {
      PlotCurve curve{.color = band_color(material.bands, band)};
      if (side == brdf) curve.name = band_label(material.bands, band);  // one legend serves both
      add_curve(panel, std::move(curve), cells, side, [&](std::size_t row, bool is_light_side) {
        return in_plane(bands[band].bsdf.*side, cells, row, is_light_side);
      });
    }
  }
  const std::size_t middle = bands.size() / 2;
  if (options.orders)
    for (const SideOf side : sides)
      plot.panels.push_back(order_panel(options, material, cells, bands[middle], middle, side));
  save_svg(plot, options.plot);
}

}  // namespace

void run_monte_carlo_bsdf(const BsdfOptions& options) {
  if (!(0.0 <= options.theta_i_deg && options.theta_i_deg < 90.0))
    throw InvalidInput(
        fmt::format("--theta-i must lie in [0, 90) degrees, but is {}", options.theta_i_deg));
  if (options.azimuths % 2 != 0)
    throw InvalidInput(fmt::format(
        "--azimuths: must be even, one half on each side of the plane of incidence, but is {}",
        options.azimuths));
  const Material material =
      find_material_at({options.material, options.bands, options.settings}, options.common.memory);
  const Cells cells{static_cast<std::size_t>(options.cosines),
                    static_cast<std::size_t>(options.azimuths / 2)};
  std::vector<BandResult> bands;
  for (std::size_t band = 0; band < material.bands.size(); ++band) {
    MonteCarloOptions photons = monte_carlo_options(options.effort, options.common, band);
    photons.incidence.theta = options.theta_i_deg * degree;
    photons.tallies.bsdf_cosines = options.cosines;
    photons.tallies.bsdf_azimuths = options.azimuths;
    photons.tallies.orders = options.orders;
    photons.seconds /= static_cast<double>(material.bands.size());
    photons.progress = make_progress("photons of band " + band_name(material.bands, band));
    bands.push_back(trace(layer_stack(material, band), photons, cells));
  }
  double unfinished = 0.0;
  for (const BandResult& band : bands)
    unfinished = std::max(unfinished, band.totals.unfinished.value);
  if (unfinished > 0.0) say("note: " + unfinished_remark(unfinished));
  write_plot(options, material, cells, bands);
  write_json(to_json(options, material, cells, bands), options.common);
  print(options.common, to_text(options, material, cells, bands));
}

}  // namespace lamina::cli
