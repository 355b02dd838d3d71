// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "profile_frequency.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

#include "lamina/solve/scattering/transport_profile/gaussian_profile.h"
#include "lamina/solve/scattering/transport_profile/spatial_frequency_response.h"
#include "layer_derivatives.h"
#include "material_bands.h"

namespace lamina::cli {
namespace {

JsonOutput result_with(const JsonOutput& head) {
  JsonOutput json = make_result("profile");
  json["method"] = "radiative_transfer";
  json.update(head);
  json["per"] = "arriving_flux";
  return json;
}

/// [side][by what][layer][k][band]
JsonOutput wave_derivatives_json(const SpatialFrequencyDerivatives& found, std::size_t bands) {
  const auto of_side = [&](const std::vector<std::vector<LayerDerivatives>>& side) {
    return layer_derivatives_json(side[0].size(),
                                  [&](std::size_t layer, double LayerDerivatives::*derivative) {
                                    std::vector<double> values;
                                    for (const std::vector<LayerDerivatives>& layers : side)
                                      values.push_back(layers[layer].*derivative);
                                    return table_json(values, bands);
                                  });
  };
  return {{"reflectance", of_side(found.reflectance)},
          {"transmittance", of_side(found.transmittance)}};
}

/// At the first, the middle and the last frequency.
std::string wave_derivatives_text(const Material& material, const std::vector<LayerStack>& stacks,
                                  const SpatialFrequencyDerivatives& found) {
  std::string text;
  const std::vector<double>& k = found.response.k;
  for (const std::size_t i : {std::size_t{0}, k.size() / 2, k.size() - 1}) {
    text +=
        fmt::format("\nat k {:.4g} /mm\n", k[i]) + layer_derivatives_head("a response", material);
    const auto add = [&](const char* name, const std::vector<double>& values,
                         const std::vector<std::vector<LayerDerivatives>>& derivatives) {
      std::vector<DifferentiatedNumber> bands;
      for (std::size_t b = 0; b < stacks.size(); ++b)
        bands.push_back({values[i * stacks.size() + b], &derivatives[i * stacks.size() + b]});
      text += layer_derivatives_text(name, material, stacks, bands);
    };
    add("R", found.response.reflectance, found.reflectance);
    add("T", found.response.transmittance, found.transmittance);
    text += "\n";
  }
  return text;
}

}  // namespace

void run_profile_frequency(const Material& material, const RadialGrid& grid,
                           const TransferProfileOptions& options, bool has_derivatives,
                           const JsonOutput& head, const CommonOptions& common) {
  const std::vector<LayerStack> stacks = layer_stacks(material);
  std::vector<double> k{0.0};
  for (const double r : radii(grid)) k.push_back(1.0 / r);
  std::sort(k.begin(), k.end());
  SpatialFrequencyDerivatives derivatives;
  if (has_derivatives)
    derivatives = spatial_frequency_derivatives(stacks, k, options);
  else
    derivatives.response = spatial_frequency_response(stacks, k, options);
  const SpatialFrequencyResponse& response = derivatives.response;
  std::string text = fmt::format("{:>10}", "k [1/mm]");
  for (const char* side : {"R", "T"})
    for (std::size_t band = 0; band < stacks.size(); ++band)
      text += fmt::format("  {:>10}", fmt::format("{} {}", side, band_name(material.bands, band)));
  text += fmt::format("  {:>9}", "error");
  const std::size_t rows = std::min<std::size_t>(k.size(), 24);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t i = row * (k.size() - 1) / (rows - 1);
    text += fmt::format("\n{:10.4g}", k[i]);
    for (const auto* values : {&response.reflectance, &response.transmittance})
      for (std::size_t band = 0; band < stacks.size(); ++band)
        text += fmt::format("  {:10.3e}", (*values)[i * stacks.size() + band]);
    double error = 0.0;  // the largest of the row
    for (const auto* errors : {&response.reflectance_error, &response.transmittance_error})
      for (std::size_t band = 0; band < stacks.size(); ++band)
        error = std::max(error, (*errors)[i * stacks.size() + band]);
    text += fmt::format("  {:9.1e}", error);
  }
  const double worst = std::ranges::max(response.largest_error);
  if (worst > options.accuracy)
    text += fmt::format("\nnote: accurate to {:.2g} % only, where {:.2g} % was asked for",
                        100.0 * worst, 100.0 * options.accuracy);
  if (has_derivatives) text += "\n" + wave_derivatives_text(material, stacks, derivatives);
  JsonOutput json = result_with(head);
  json["estimated_error"] = response.largest_error;
  json["nodes"] = response.nodes;
  json["modes"] = response.modes;
  json["k_per_mm"] = k;
  json["reflectance"] = table_json(response.reflectance, stacks.size());
  json["transmittance"] = table_json(response.transmittance, stacks.size());
  json["reflectance_error"] = table_json(response.reflectance_error, stacks.size());
  json["transmittance_error"] = table_json(response.transmittance_error, stacks.size());
  if (has_derivatives) json["derivatives"] = wave_derivatives_json(derivatives, stacks.size());
  write_json(json, common);
  print(common, text + "\n");
}

void run_profile_gaussians(const Material& material, int count,
                           const TransferProfileOptions& options, const JsonOutput& head,
                           const CommonOptions& common) {
  const std::vector<LayerStack> stacks = layer_stacks(material);
  const GaussianProfile fit = fit_gaussian_profile(stacks, count, options);
  const std::size_t bands = stacks.size();
  std::string text;
  JsonOutput json = result_with(head);
  json["variances_mm2"] = fit.variances;
  const auto add = [&](const std::string& name, const std::vector<GaussianFit>& of_band) {
    text += fmt::format("{} by Gaussians: weight of each\n{:>14}", name, "variance [mm²]");
    for (std::size_t b = 0; b < bands; ++b)
      text += fmt::format("  {:>9}", band_name(material.bands, b));
    std::vector<double> weights, rms, largest;
    for (std::size_t i = 0; i < fit.variances.size(); ++i) {
      text += fmt::format("\n{:14.4g}", fit.variances[i]);
      for (const GaussianFit& band : of_band) {
        weights.push_back(band.sum.weights[i]);
        text += fmt::format("  {:9.6f}", band.sum.weights[i]);
      }
    }
    text += fmt::format("\n{:>14}", "rms error [%]");
    for (const GaussianFit& band : of_band) {
      text += fmt::format("  {:9.3f}", 100.0 * band.rms_error);
      rms.push_back(band.rms_error);
    }
    text += fmt::format("\n{:>14}", "largest [%]");
    for (const GaussianFit& band : of_band) {
      text += fmt::format("  {:9.3f}", 100.0 * band.largest_error);
      largest.push_back(band.largest_error);
    }
    text += "\n";
    json[name + "_weights"] = table_json(weights, bands);
    json[name + "_rms_error"] = rms;
    json[name + "_largest_error"] = largest;
  };
  add("reflectance", fit.reflectance);
  if (!fit.transmittance.empty()) {
    text += "\n";
    add("transmittance", fit.transmittance);
  }
  write_json(json, common);
  print(common, text);
}

}  // namespace lamina::cli
