// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "bsdf_options.h"
#include "degrees.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/base/plot/plot.h"
#include "lamina/layers/materials/material.h"
#include "lamina/solve/scattering/layered_bsdf/layered_bsdf.h"
#include "material_bands.h"

namespace lamina::cli {
namespace {

/// The angles to look from, in degrees.
struct Angles {
  std::vector<double> theta, phi;
};

Angles make_angles(double step) {
  Angles angles;
  for (int i = 0; i * step < 90.0; ++i) angles.theta.push_back(i * step);
  for (int j = 0; j * step <= 180.0 + 1e-9; ++j) angles.phi.push_back(std::min(j * step, 180.0));
  return angles;
}

std::vector<double> in_radians(std::vector<double> degrees) {
  for (double& angle : degrees) angle *= degree;
  return degrees;
}

/// [theta][phi][band] of one member of the bands' results.
JsonOutput by_angles(const std::vector<StackBsdf>& bands, const Angles& angles,
                     const std::vector<double> StackBsdf::*values) {
  JsonOutput rows = JsonOutput::array();
  for (std::size_t i = 0; i < angles.theta.size(); ++i) {
    JsonOutput& row = rows.emplace_back(JsonOutput::array());
    for (std::size_t j = 0; j < angles.phi.size(); ++j) {
      JsonOutput& cell = row.emplace_back(JsonOutput::array());
      for (const StackBsdf& band : bands) cell.push_back((band.*values)[i * angles.phi.size() + j]);
    }
  }
  return rows;
}

JsonOutput by_band(const std::vector<StackBsdf>& bands,
                   const std::function<double(const StackBsdf&)>& value) {
  JsonOutput list = JsonOutput::array();
  for (const StackBsdf& band : bands) list.push_back(value(band));
  return list;
}

/// A method and what it found, [band].
struct NamedBsdf {
  std::string method;
  std::vector<StackBsdf> bands;
};

JsonOutput to_json(const BsdfOptions& options, const Material& material, const Angles& angles,
                   const NamedBsdf& result) {
  const std::vector<StackBsdf>& bands = result.bands;
  JsonOutput json = make_result("bsdf");
  json["material"] = material.name;
  json["method"] = result.method;
  JsonOutput& names = json["bands"] = JsonOutput::array();
  for (std::size_t band = 0; band < bands.size(); ++band) {
    if (material.bands.is_rgb())
      names.push_back(band_name(material.bands, band));
    else
      names.push_back(material.bands.wavelengths()[band]);
  }
  json["theta_i_deg"] = options.theta_i_deg;
  json["theta_o_deg"] = angles.theta;
  json["phi_o_deg"] = angles.phi;  // 0 is forward: the mirror's side
  json["brdf"] = by_angles(bands, angles, &StackBsdf::brdf);
  json["btdf"] = by_angles(bands, angles, &StackBsdf::btdf);
  json["unscattered_reflectance"] =
      by_band(bands, [](const StackBsdf& b) { return b.unscattered_reflectance; });
  json["unscattered_transmittance"] =
      by_band(bands, [](const StackBsdf& b) { return b.unscattered_transmittance; });
  if (result.method == "radiative_transfer")
    json["estimated_error"] = by_band(bands, [](const StackBsdf& b) { return b.estimated_error; });
  return json;
}

std::string to_text(const BsdfOptions& options, const Material& material, const Angles& angles,
                    const NamedBsdf& result) {
  const std::vector<StackBsdf>& bands = result.bands;
  std::string text = fmt::format(
      "{}, light from {:.4g}°, {}: 1/sr in the plane of "
      "incidence, < 0 on the side of the light\n\n",
      material.name, options.theta_i_deg, result.method);
  text += fmt::format("{:>8}", "theta_o");
  for (const char* side : {"brdf", "btdf"})
    for (std::size_t band = 0; band < bands.size(); ++band)
      text += fmt::format("{:>12}", fmt::format("{} {}", side, band_name(material.bands, band)));
  text += "\n";
  const auto line = [&](std::size_t i, bool is_light_side) {
    text += fmt::format("{:>8.4g}", is_light_side ? -angles.theta[i] : angles.theta[i]);
    const std::size_t k = i * angles.phi.size() + (is_light_side ? angles.phi.size() - 1 : 0);
    for (const auto values : {&StackBsdf::brdf, &StackBsdf::btdf})
      for (const StackBsdf& band : bands) text += fmt::format("{:>12.5g}", (band.*values)[k]);
    text += "\n";
  };
  for (std::size_t i = angles.theta.size(); i-- > 1;) line(i, true);
  for (std::size_t i = 0; i < angles.theta.size(); ++i) line(i, false);
  text += "\nnot scattered:";
  for (std::size_t band = 0; band < bands.size(); ++band)
    text += fmt::format("  {} {:.4f} back, {:.4f} through", band_name(material.bands, band),
                        bands[band].unscattered_reflectance, bands[band].unscattered_transmittance);
  text += "\n";
  for (std::size_t band = 0; band < bands.size(); ++band)
    if (!bands[band].is_accurate)
      text += fmt::format("warning: {} is accurate to {:.1g} only\n",
                          band_name(material.bands, band), bands[band].estimated_error);
  return text;
}

NamedBsdf solve(const BsdfOptions& options, const Material& material, const Angles& angles,
                const std::string& method) {
  NamedBsdf result{method, std::vector<StackBsdf>(material.bands.size())};
  const double theta_i = options.theta_i_deg * degree;
  const std::vector<double> theta_o = in_radians(angles.theta), phi_o = in_radians(angles.phi);
  if (method == "radiative_transfer") {
    std::vector<LayerStack> stacks;
    for (std::size_t band = 0; band < material.bands.size(); ++band)
      stacks.push_back(layer_stack(material, band));
    result.bands = stack_bsdf(
        stacks, theta_i, theta_o, phi_o,
        {.accuracy = options.accuracy, .progress = make_progress(method, Keeps::nothing)});
    return result;
  }
  const auto solve_band = [&](std::size_t band) {
    result.bands[band] =
        layered_bsdf(layer_stack(material, band),
                     method == "first_order" ? ScatteringOrders::first : ScatteringOrders::all,
                     theta_i, theta_o, phi_o);
  };
  parallel_for(result.bands.size(), solve_band, make_progress(method, Keeps::nothing));
  return result;
}

/// Polar diagrams of the plane of incidence, as [HanrahanKrueger1993] Figure 9.
void write_plot(const BsdfOptions& options, const Material& material, const Angles& angles,
                const std::vector<NamedBsdf>& results) {
  if (options.plot.empty()) return;
  constexpr std::array styles = {CurveStyle::line, CurveStyle::dashed, CurveStyle::dotted};
  Plot plot{.title = fmt::format("{}, light from {:.4g}°", material.name, options.theta_i_deg),
            .caption =
                "radiance per irradiance in the plane of incidence; unscattered light has no "
                "finite radiance and is left out"};
  for (const auto values : {&StackBsdf::brdf, &StackBsdf::btdf}) {
    const bool is_above = values == &StackBsdf::brdf;
    PlotPanel panel;
    panel.title = is_above ? "reflected" : "transmitted";
    panel.kind = PlotPanelKind::polar;
    panel.y.label = "[1/sr]";
    panel.arrow_angle = -options.theta_i_deg * degree;
    double largest = 0.0;
    for (std::size_t r = 0; r < results.size(); ++r)
      for (std::size_t band = 0; band < material.bands.size(); ++band) {
        PlotCurve curve{.color = band_color(material.bands, band),
                        .style = styles[r % styles.size()]};
        if (is_above)  // one legend serves both
          curve.name = band_label(material.bands, band) +
                       (results.size() > 1 ? " " + results[r].method : "");
        const auto& of_band = results[r].bands[band].*values;
        const auto add = [&](std::size_t i, bool is_light_side) {
          const double theta = angles.theta[i] * degree;
          const double from_normal = is_above ? theta : std::numbers::pi - theta;
          curve.x.push_back(is_light_side ? -from_normal : from_normal);
          curve.y.push_back(
              of_band[i * angles.phi.size() + (is_light_side ? angles.phi.size() - 1 : 0)]);
          largest = std::max(largest, curve.y.back());
        };
        for (std::size_t i = angles.theta.size(); i-- > 1;) add(i, true);
        for (std::size_t i = 0; i < angles.theta.size(); ++i) add(i, false);
        panel.curves.push_back(std::move(curve));
      }
    if (is_above || largest > 0.0) plot.panels.push_back(std::move(panel));
  }
  save_svg(plot, options.plot);
}

/// All methods beside radiative transfer, with the fraction of the light that each sends elsewhere.
void compare_methods(const BsdfOptions& options, const Material& material, const Angles& angles) {
  std::vector<NamedBsdf> results;
  for (const char* method : {"radiative_transfer", "layered_bsdf", "first_order"})
    results.push_back(solve(options, material, angles, method));
  const std::vector<StackBsdf>& truth = results.front().bands;
  JsonOutput json = make_result("bsdf");
  json["material"] = material.name;
  json["method"] = "compare";
  json["theta_i_deg"] = options.theta_i_deg;
  std::string text =
      fmt::format("{}, light from {:.4g}°: light sent elsewhere than by {}\n\n{:<20}",
                  material.name, options.theta_i_deg, results.front().method, "");
  for (const char* side : {"reflected", "transmitted"})
    for (std::size_t band = 0; band < truth.size(); ++band)
      text += fmt::format("{:>19}", fmt::format("{} {}", side, band_name(material.bands, band)));
  text += "\n";
  for (const NamedBsdf& result : results) {
    JsonOutput& entry = json["methods"].emplace_back(to_json(options, material, angles, result));
    if (&result == &results.front()) continue;
    text += fmt::format("{:<20}", result.method);
    for (const auto values : {&StackBsdf::brdf, &StackBsdf::btdf}) {
      JsonOutput row = JsonOutput::array();
      for (std::size_t band = 0; band < truth.size(); ++band) {
        const double misplaced = misplaced_light(result.bands[band].*values, truth[band].*values,
                                                 in_radians(angles.theta), in_radians(angles.phi));
        row.push_back(misplaced);
        text += fmt::format("{:>19.4f}", misplaced);
      }
      entry[values == &StackBsdf::brdf ? "misplaced_reflection" : "misplaced_transmission"] = row;
    }
    text += "\n";
  }
  write_plot(options, material, angles, results);
  write_json(json, options.common);
  print(options.common, text);
}

}  // namespace

void run_material_bsdf(const BsdfOptions& options) {
  const std::string method = options.method.empty() ? "radiative_transfer" : options.method;
  constexpr std::array<std::string_view, 4> methods = {"radiative_transfer", "first_order",
                                                       "layered_bsdf", "monte_carlo"};
  if (std::ranges::find(methods, method) == methods.end())
    throw InvalidInput(
        "--method of a material must be radiative_transfer, first_order, layered_bsdf or "
        "monte_carlo, but is " +
        options.method + did_you_mean(options.method, methods));
  if (!(0.0 <= options.theta_i_deg && options.theta_i_deg < 90.0))
    throw InvalidInput(
        fmt::format("--theta-i must lie in [0, 90) degrees, but is {}", options.theta_i_deg));
  const Material material =
      find_material_at({options.material, options.bands, options.settings}, options.common.memory);
  const Angles angles = make_angles(options.step_deg);
  if (options.compare) return compare_methods(options, material, angles);
  const NamedBsdf result = solve(options, material, angles, method);
  write_plot(options, material, angles, {result});
  write_json(to_json(options, material, angles, result), options.common);
  print(options.common, to_text(options, material, angles, result));
}

}  // namespace lamina::cli
