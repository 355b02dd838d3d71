// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "bsdf_options.h"
#include "lamina/core/error.h"
#include "lamina/core/parallel.h"
#include "lamina/materials/material.h"
#include "lamina/scattering/adding_doubling_bsdf.h"

namespace lamina::cli {
namespace {

using nlohmann::ordered_json;

constexpr double degree = std::numbers::pi / 180.0;

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
ordered_json by_angles(const std::vector<StackBsdf>& bands, const Angles& angles,
                       const std::vector<double> StackBsdf::* values) {
  ordered_json rows = ordered_json::array();
  for (std::size_t i = 0; i < angles.theta.size(); ++i) {
    ordered_json& row = rows.emplace_back(ordered_json::array());
    for (std::size_t j = 0; j < angles.phi.size(); ++j) {
      ordered_json& cell = row.emplace_back(ordered_json::array());
      for (const StackBsdf& band : bands) cell.push_back((band.*values)[i * angles.phi.size() + j]);
    }
  }
  return rows;
}

ordered_json by_band(const std::vector<StackBsdf>& bands,
                     const std::function<double(const StackBsdf&)>& value) {
  ordered_json list = ordered_json::array();
  for (const StackBsdf& band : bands) list.push_back(value(band));
  return list;
}

ordered_json to_json(const BsdfOptions& options, const Material& material, const Angles& angles,
                     const std::vector<StackBsdf>& bands) {
  ordered_json json = make_result("bsdf");
  json["material"] = material.name;
  json["method"] = "adding_doubling";
  ordered_json& names = json["bands"] = ordered_json::array();
  for (std::size_t band = 0; band < bands.size(); ++band) {
    if (material.bands.is_rgb())
      names.push_back(band_name(material.bands, band));
    else
      names.push_back(material.bands.wavelengths()[band]);
  }
  json["theta_i_deg"] = options.theta_i_deg;
  json["theta_o_deg"] = angles.theta;
  json["phi_o_deg"] = angles.phi;  // from the azimuth of the light: 180 is the mirror's side
  json["brdf"] = by_angles(bands, angles, &StackBsdf::brdf);
  json["btdf"] = by_angles(bands, angles, &StackBsdf::btdf);
  json["unscattered_reflectance"] =
      by_band(bands, [](const StackBsdf& b) { return b.unscattered_reflectance; });
  json["unscattered_transmittance"] =
      by_band(bands, [](const StackBsdf& b) { return b.unscattered_transmittance; });
  json["estimated_error"] = by_band(bands, [](const StackBsdf& b) { return b.estimated_error; });
  return json;
}

std::string to_text(const BsdfOptions& options, const Material& material, const Angles& angles,
                    const std::vector<StackBsdf>& bands) {
  std::string text = fmt::format(
      "{}, light from {:.4g}°, adding_doubling: 1/sr in the plane of "
      "incidence, < 0 on the side of the light\n\n",
      material.name, options.theta_i_deg);
  text += fmt::format("{:>8}", "theta_o");
  for (const char* side : {"brdf", "btdf"})
    for (std::size_t band = 0; band < bands.size(); ++band)
      text += fmt::format("{:>12}", fmt::format("{} {}", side, band_name(material.bands, band)));
  text += "\n";
  const auto line = [&](std::size_t i, bool is_light_side) {
    text += fmt::format("{:>8.4g}", is_light_side ? -angles.theta[i] : angles.theta[i]);
    const std::size_t k = i * angles.phi.size() + (is_light_side ? 0 : angles.phi.size() - 1);
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

}  // namespace

void run_material_bsdf(const BsdfOptions& options) {
  if (!options.method.empty() && options.method != "adding_doubling")
    throw InvalidInput("--method of a material must be adding_doubling, but is " + options.method);
  if (!(0.0 <= options.theta_i_deg && options.theta_i_deg < 90.0))
    throw InvalidInput(
        fmt::format("--theta-i must lie in [0, 90) degrees, but is {}", options.theta_i_deg));
  const Material material = find_material(options.material);
  const Angles angles = make_angles(options.step_deg);
  std::vector<StackBsdf> bands(material.bands.size());
  parallel_for(bands.size(), [&](std::size_t band) {
    bands[band] = stack_bsdf(layer_stack(material, band), options.theta_i_deg * degree,
                             in_radians(angles.theta), in_radians(angles.phi),
                             {.accuracy = options.accuracy});
  });
  write_json(to_json(options, material, angles, bands), options.common);
  print(options.common, to_text(options, material, angles, bands));
}

}  // namespace lamina::cli
