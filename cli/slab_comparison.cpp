// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "slab_comparison.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lamina/base/core/error.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "material_bands.h"
#include "monte_carlo_method.h"

namespace lamina::cli {
namespace {

constexpr double transfer_accuracy = 1e-6;

/// One fraction of the light as three methods find it, in one band.
struct Row {
  std::string name;
  std::size_t band;
  double transfer;
  Estimate photons;
  double diffusion;  ///< nan where it refuses the stack
  /// Of both: what the photons know, and what adding-doubling was asked for.
  [[nodiscard]] double in_standard_errors() const {
    return (photons.value - transfer) / std::hypot(photons.standard_error, transfer_accuracy);
  }
};

std::vector<Row> rows_of(const Material& material, std::size_t band, const SlabTotals& transfer,
                         const MonteCarloResult& photons, const SlabTotals& diffusion) {
  std::vector<Row> rows = {{"specular reflectance", band, transfer.specular_reflectance,
                            photons.specular_reflectance, diffusion.specular_reflectance},
                           {"diffuse reflectance", band, transfer.diffuse_reflectance,
                            photons.diffuse_reflectance, diffusion.diffuse_reflectance},
                           {"transmittance", band, transfer.transmittance, photons.transmittance,
                            diffusion.transmittance}};
  for (std::size_t k = 0; k < transfer.absorptance.size(); ++k)
    rows.push_back({"absorbed: " + (material.layers[k].name.empty() ? fmt::format("layer {}", k)
                                                                    : material.layers[k].name),
                    band, transfer.absorptance[k], photons.absorptance[k],
                    diffusion.absorptance[k]});
  return rows;
}

std::string to_text(const Material& material, const std::vector<Row>& rows) {
  std::string text = fmt::format("{:<28} {:>4}  {:>18}  {:>20} {:>6}  {:>9} {:>8}\n", "", "band",
                                 "radiative_transfer", "monte_carlo", "sigmas", "diffusion", "off");
  for (const Row& row : rows) {
    text += fmt::format("{:<28} {:>4}  {:>18.6f}  {:>9.6f} ± {:>8.6f} {:>+6.1f}", row.name,
                        band_name(material.bands, row.band), row.transfer, row.photons.value,
                        row.photons.standard_error, row.in_standard_errors());
    const double off = row.transfer > 1e-9 ? 100.0 * (row.diffusion / row.transfer - 1.0) : 0.0;
    text += std::isnan(row.diffusion) ? fmt::format("  {:>9} {:>8}\n", "-", "-")
                                      : fmt::format("  {:>9.6f} {:>+7.1f}%\n", row.diffusion, off);
  }
  return text;
}

/// Diffusion needs scattering in every layer; the other methods compare without it.
SlabTotals diffusion_or_nan(const LayerStack& stack, const Incidence& incidence) {
  try {
    return diffusion_totals(stack, incidence);
  } catch (const InvalidInput& error) {
    say(fmt::format("note: {}", error.what()));
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan, nan, std::vector<double>(stack.layers().size(), nan)};
  }
}

}  // namespace

void run_slab_comparison(const Material& material, const std::vector<LayerStack>& stacks,
                         const Incidence& incidence, std::int64_t photons,
                         const CommonOptions& options) {
  const auto transfer =
      adding_doubling(stacks, incidence,
                      {.accuracy = transfer_accuracy,
                       .progress = make_progress("adding-doubling", Keeps::nothing)});
  std::vector<Row> rows;
  std::vector<double> unfinished;
  for (std::size_t band = 0; band < stacks.size(); ++band) {
    MonteCarloOptions effort{.photons = static_cast<std::uint64_t>(photons), .seed = options.seed};
    effort.incidence = incidence;
    effort.progress = make_progress("photons of band " + band_name(material.bands, band));
    const MonteCarloResult traced = trace_photons(stacks[band], effort);
    unfinished.push_back(traced.unfinished.value);
    const SlabTotals diffusion = diffusion_or_nan(stacks[band], incidence);
    for (Row& row : rows_of(material, band, transfer[band].totals, traced, diffusion))
      rows.push_back(std::move(row));
  }
  const std::string remark = unfinished_remark(std::ranges::max(unfinished));
  if (!remark.empty()) say("note: " + remark);
  JsonOutput json = make_result("slab");
  json["method"] = "compare";
  json["material"] = material.name;
  json["bands"] = bands_json(material.bands);
  json["photons"] = photons;
  json["unfinished"] = unfinished;
  json["rows"] = JsonOutput::array();
  for (const Row& row : rows)
    json["rows"].push_back(
        {{"name", row.name},
         {"band", band_name(material.bands, row.band)},
         {"radiative_transfer", row.transfer},
         {"monte_carlo", row.photons.value},
         {"standard_error", row.photons.standard_error},
         {"difference_in_standard_errors", row.in_standard_errors()},
         {"diffusion", std::isnan(row.diffusion) ? JsonOutput() : JsonOutput(row.diffusion)}});
  write_json(json, options);
  print(options, to_text(material, rows));
}

}  // namespace lamina::cli
