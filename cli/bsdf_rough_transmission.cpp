// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "bsdf_options.h"
#include "degrees.h"
#include "lamina/base/core/error.h"
#include "lamina/base/plot/plot.h"
#include "lamina/layers/optics/rough/rough_surface_scattering.h"

namespace lamina::cli {
namespace {

std::int64_t rays(const BsdfOptions& options) {
  if (options.effort.relative_error > 0.0 || options.effort.seconds > 0.0)
    throw InvalidInput(
        "--relative-error and --time: are for materials; this model takes --photons");
  if (options.effort.has_independent_bands)
    throw InvalidInput("--independent-bands: is for materials; this model has one band");
  return static_cast<std::int64_t>(monte_carlo_options(options.effort, options.common).photons);
}

RoughSurfaceScattering scatter(const BsdfOptions& options, const std::string& method,
                               FacetVisibility visibility) {
  const GaussianSurface surface{.smoothness = options.smoothness, .eta = options.eta};
  if (!(0.0 <= options.theta_i_deg && options.theta_i_deg < 90.0))
    throw InvalidInput(
        fmt::format("--theta-i must lie in [0, 90) degrees, but is {}", options.theta_i_deg));
  const double theta_i = options.theta_i_deg * degree;
  if (method == "analytic") return analytic_scattering(surface, theta_i);
  if (method == "monte_carlo")
    return simulate_scattering(surface, theta_i,
                               {.rays = rays(options),
                                .seed = options.common.seed,
                                .visibility = visibility,
                                .progress = make_progress("rays")});
  if (method == "height_field")
    return trace_height_fields(surface, theta_i,
                               {.rays = rays(options),
                                .realizations = options.realizations,
                                .seed = options.common.seed,
                                .progress = make_progress("surfaces")});
  throw InvalidInput(
      "--method of rough_transmission must be analytic, monte_carlo or height_field, "
      "but is " +
      method);
}

/// values[theta * phis + phi] as array[theta][phi][band], of one band.
JsonOutput by_angles(const std::vector<double>& values, int phis) {
  JsonOutput rows = JsonOutput::array();
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k % static_cast<std::size_t>(phis) == 0) rows.push_back(JsonOutput::array());
    rows.back().push_back(JsonOutput::array({values[k]}));
  }
  return rows;
}

JsonOutput centers_deg(int cells, double range_deg) {
  JsonOutput centers = JsonOutput::array();
  for (int i = 0; i < cells; ++i) centers.push_back((i + 0.5) * range_deg / cells);
  return centers;
}

JsonOutput to_json(const BsdfOptions& options, const std::string& method,
                   const RoughSurfaceScattering& result) {
  const auto& [thetas, phis] = result.cells;
  const auto one_band = [](double value) { return JsonOutput::array({value}); };
  JsonOutput json = make_result("bsdf");
  json["model"] = "rough_transmission";
  json["method"] = method;
  json["bands"] = JsonOutput::array({"all"});
  json["eta"] = options.eta;
  json["smoothness"] = options.smoothness;
  json["theta_i_deg"] = options.theta_i_deg;
  if (method == "monte_carlo") json["visibility"] = name_of(options.visibility);
  json["theta_o_deg"] = centers_deg(thetas, 90.0);
  json["phi_o_deg"] = centers_deg(phis, 180.0);  // 0 is forward
  json["brdf"] = by_angles(result.brdf, phis);
  json["btdf"] = by_angles(result.btdf, phis);
  json["single_brdf"] = by_angles(result.single_brdf, phis);
  json["single_btdf"] = by_angles(result.single_btdf, phis);
  json["reflectance"] = one_band(result.reflectance.value);
  json["transmittance"] = one_band(result.transmittance.value);
  json["single_reflectance"] = one_band(result.single_reflectance.value);
  json["single_transmittance"] = one_band(result.single_transmittance.value);
  json["start_weight"] = one_band(result.start_weight.value);
  if (method == "analytic") return json;
  json["standard_error"] = {
      {"brdf", by_angles(result.brdf_error, phis)},
      {"btdf", by_angles(result.btdf_error, phis)},
      {"reflectance", one_band(result.reflectance.standard_error)},
      {"transmittance", one_band(result.transmittance.standard_error)},
      {"single_reflectance", one_band(result.single_reflectance.standard_error)},
      {"single_transmittance", one_band(result.single_transmittance.standard_error)},
      {"start_weight", one_band(result.start_weight.standard_error)}};
  return json;
}

std::string with_error(const Estimate& estimate) {
  return estimate.standard_error > 0.0
             ? fmt::format("{:.4f} ± {:.4f}", estimate.value, estimate.standard_error)
             : fmt::format("{:.4f}", estimate.value);
}

/// Angle and height of the highest cell in the plane of incidence, forward or back.
std::string peak_of(const std::vector<double>& bsdf, const ExitCells& cells) {
  double best = -1.0, angle = 0.0;
  for (int i = 0; i < cells.thetas; ++i)
    for (const int j : {0, cells.phis - 1}) {
      const double theta = (i + 0.5) * 90.0 / cells.thetas;
      const double value = bsdf[static_cast<std::size_t>(i * cells.phis + j)];
      if (value > best) best = value, angle = j == 0 ? theta : -theta;
    }
  return fmt::format("{:.3g} /sr at {:.0f}°", best, angle);
}

std::string to_text(const BsdfOptions& options, const std::string& method,
                    const RoughSurfaceScattering& result) {
  std::string text = fmt::format(
      "rough surface, eta {:.4g}, smoothness {:.4g} (roughness {:.3g}), light from {:.4g}°, {}\n\n",
      options.eta, options.smoothness, 2.0 / options.smoothness, options.theta_i_deg, method);
  const bool single_only = method == "analytic";
  const auto row = [&](const char* name, const Estimate& single, const Estimate& all,
                       const std::vector<double>& bsdf) {
    text += fmt::format("{:<13} one facet {:<18}", name, with_error(single));
    if (!single_only) text += fmt::format("  all {:<18}", with_error(all));
    text += fmt::format("  peak {}\n", peak_of(bsdf, result.cells));
  };
  row("reflectance", result.single_reflectance, result.reflectance, result.brdf);
  row("transmittance", result.single_transmittance, result.transmittance, result.btdf);
  const double returned = result.reflectance.value + result.transmittance.value;
  if (single_only)
    text += fmt::format("left out      {:.2f} % of the light, which meets more facets\n",
                        100.0 * std::max(0.0, 1.0 - returned));
  else if (method == "monte_carlo")
    text += fmt::format("start weight  {} (energy lost {:.2f} %)\n",
                        with_error(result.start_weight), 100.0 * (1.0 - returned));
  if (result.given_up > 0.0)
    text += fmt::format("given up      {:.2g} of the light\n", result.given_up);
  return text;
}

/// A method and what it found.
struct NamedScattering {
  std::string name;
  RoughSurfaceScattering result;
};

/// Light that leaves in the plane of incidence, from the cells along it: bsdf * cos(theta_o) over
/// the angle from the upward normal, positive away from the light. Where the cells are noisy, means
/// over three by three of them.
PlotCurve lobe_of(const NamedScattering& named, bool is_transmitted) {
  const RoughSurfaceScattering& result = named.result;
  const auto& [thetas, phis] = result.cells;
  const std::vector<double>& bsdf = is_transmitted ? result.btdf : result.brdf;
  const std::vector<double>& error = is_transmitted ? result.btdf_error : result.brdf_error;
  double values = 0.0, errors = 0.0;
  for (int i = 0; i < thetas; ++i) {
    values += bsdf[static_cast<std::size_t>(i * phis)];
    errors += error[static_cast<std::size_t>(i * phis)];
  }
  const int merged = errors > 0.05 * values ? 3 : 1;

  PlotCurve curve{.name = named.name};
  const auto add = [&](int first_theta, int first_phi, double sign) {
    double flux = 0.0, weight = 0.0;
    for (int i = first_theta; i < first_theta + merged; ++i)
      for (int j = first_phi; j < first_phi + merged; ++j) {
        const double theta = (i + 0.5) * 90.0 / thetas * degree;
        flux += bsdf[static_cast<std::size_t>(i * phis + j)] * std::cos(theta) * std::sin(theta);
        weight += std::sin(theta);
      }
    const double theta = (first_theta + 0.5 * merged) * 90.0 / thetas * degree;
    curve.x.push_back(sign * (is_transmitted ? std::numbers::pi - theta : theta));
    curve.y.push_back(flux / weight);
  };
  for (int i = thetas - merged; i >= 0; i -= merged) add(i, phis - merged, -1.0);
  for (int i = 0; i < thetas; i += merged) add(i, 0, 1.0);
  return curve;
}

/// Polar diagrams in the style of [XuSun2008] Figures 5 to 9.
void write_plot(const BsdfOptions& options, const std::vector<NamedScattering>& results) {
  if (options.plot.empty()) return;
  Plot plot{.title = fmt::format("Rough surface, eta {:.4g}, smoothness {:.4g}", options.eta,
                                 options.smoothness),
            .caption = "power per solid angle in the plane of incidence, of 1 that arrives"};
  for (const bool is_transmitted : {false, true}) {
    PlotPanel& panel = plot.panels.emplace_back();
    panel.title = is_transmitted ? "transmitted" : "reflected";
    panel.kind = PlotPanelKind::polar;
    panel.y.label = "[1/sr]";
    panel.arrow_angle = -options.theta_i_deg * degree;
    for (const NamedScattering& named : results)
      panel.curves.push_back(lobe_of(named, is_transmitted));
    if (is_transmitted)  // one legend serves both
      for (PlotCurve& curve : panel.curves) curve.name.clear();
  }
  save_svg(plot, options.plot);
}

void compare_methods(const BsdfOptions& options) {
  const std::vector<NamedScattering> all = {
      {"analytic", scatter(options, "analytic", {})},
      {"monte_carlo, xu_sun", scatter(options, "monte_carlo", FacetVisibility::xu_sun)},
      {"monte_carlo, smith", scatter(options, "monte_carlo", FacetVisibility::smith)},
      {"height_field", scatter(options, "height_field", {})}};
  const RoughSurfaceScattering& truth = all.back().result;
  JsonOutput json = make_result("bsdf");
  json["model"] = "rough_transmission";
  json["method"] = "compare";
  json["bands"] = JsonOutput::array({"all"});
  std::string text = fmt::format(
      "rough surface, eta {:.4g}, smoothness {:.4g} (roughness {:.3g}), light from {:.4g}°\n\n"
      "{:<20} {:>10} {:>13} {:>12} {:>13} {:>10}\n",
      options.eta, options.smoothness, 2.0 / options.smoothness, options.theta_i_deg, "method",
      "T, one", "T, all", "R, one", "R, all", "misplaced");
  for (const auto& [name, result] : all) {
    const double misplaced = misplaced_transmission(result, truth);
    json["methods"].push_back(to_json(options, name, result));
    json["methods"].back()["misplaced_transmission"] = JsonOutput::array({misplaced});
    text += fmt::format("{:<20} {:>10.4f} {:>13.4f} {:>12.4f} {:>13.4f} {:>10}\n", name,
                        result.single_transmittance.value, result.transmittance.value,
                        result.single_reflectance.value, result.reflectance.value,
                        &result == &truth ? "" : fmt::format("{:.4f}", misplaced));
  }
  text += fmt::format("{:<20} {:>10.4f} {:>13.4f} {:>12.4f} {:>13.4f}\n", "  standard error",
                      truth.single_transmittance.standard_error, truth.transmittance.standard_error,
                      truth.single_reflectance.standard_error, truth.reflectance.standard_error);
  write_plot(options, all);
  write_json(json, options.common);
  print(options.common, text);
}

}  // namespace

void run_rough_transmission(const BsdfOptions& options) {
  if (options.compare) return compare_methods(options);
  const std::string method = options.method.empty() ? "analytic" : options.method;
  const RoughSurfaceScattering result = scatter(options, method, options.visibility);
  write_plot(options, {{method, result}});
  write_json(to_json(options, method, result), options.common);
  print(options.common, to_text(options, method, result));
}

}  // namespace lamina::cli
