// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "profile_oblique.h"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>
#include <string>

#include "lamina/solve/scattering/transport_profile/doubtful_profile.h"
#include "lamina/solve/scattering/transport_profile/oblique_profile.h"
#include "material_bands.h"

namespace lamina::cli {
namespace {

/// [i][m][band] as nested arrays.
JsonOutput moments_json(std::span<const double> table, std::size_t moments, std::size_t bands) {
  auto radii = JsonOutput::array();
  for (std::size_t at = 0; at < table.size(); at += moments * bands)
    radii.push_back(table_json(table.subspan(at, moments * bands), bands));
  return radii;
}

}  // namespace

void run_profile_oblique(const Material& material, const std::vector<LayerStack>& stacks,
                         double degrees, const RadialGrid& grid, int moments,
                         const JsonOutput& head, const CommonOptions& common) {
  const ObliqueProfile profile =
      oblique_profile(stacks, degrees * std::numbers::pi / 180.0, grid, moments,
                      make_progress("radiative transfer", Keeps::nothing));
  refuse_doubtful(profile.mean_error,
                  fmt::format("lamina photons --incidence {} --tally log_r", degrees));
  const std::size_t bands = profile.bands, size = profile.r.size();
  std::string text = "R(r, phi) = sum of R_m(r) cos(m phi), phi from where the beam goes on\n";
  text += fmt::format("{:>10}", "r [mm]");
  for (const char* name : {"R_0", "R_1/R_0"})
    for (std::size_t b = 0; b < bands; ++b)
      text += fmt::format("  {:>10}", fmt::format("{} {}", name, band_name(material.bands, b)));
  const std::size_t rows = std::min<std::size_t>(size, 20);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t i = row * (size - 1) / std::max<std::size_t>(rows - 1, 1);
    const auto moment = [&](std::size_t m, std::size_t b) {
      return m < profile.moments
                 ? profile.reflectance_moments[(i * profile.moments + m) * bands + b]
                 : 0.0;
    };
    text += fmt::format("\n{:10.4g}", profile.r[i]);
    for (std::size_t b = 0; b < bands; ++b) text += fmt::format("  {:10.3e}", moment(0, b));
    for (std::size_t b = 0; b < bands; ++b)
      text += fmt::format("  {:10.4f}", moment(0, b) > 0.0 ? moment(1, b) / moment(0, b) : 0.0);
  }
  JsonOutput json = make_result("profile");
  json["method"] = "radiative_transfer";
  json.update(head);
  json["incidence_deg"] = degrees;
  json["per"] = "arriving_flux";
  json["r_mm"] = profile.r;
  json["reflectance_moments"] = moments_json(profile.reflectance_moments, profile.moments, bands);
  json["transmittance_moments"] =
      moments_json(profile.transmittance_moments, profile.moments, bands);
  json["total_reflectance"] = profile.total_reflectance;
  json["total_transmittance"] = profile.total_transmittance;
  json["accuracy"] = table_json(profile.estimated_error, bands);
  json["transmittance_accuracy"] = table_json(profile.transmittance_error, bands);
  json["estimated_error"] = profile.largest_error;
  json["mean_error"] = profile.mean_error;
  write_json(json, common);
  print(common, text + "\n");
}

}  // namespace lamina::cli
