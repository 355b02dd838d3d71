// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "slab_derivatives.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "lamina/core/error.h"
#include "lamina/core/progress.h"

namespace lamina::cli {
namespace {

struct Total {
  const char* key;
  const char* name;
  std::vector<LayerDerivatives> AddingDoublingDerivatives::*derivatives;
};
constexpr std::array<Total, 3> totals = {
    {{"diffuse_reflectance", "reflectance", &AddingDoublingDerivatives::diffuse_reflectance},
     {"transmittance", "transmittance", &AddingDoublingDerivatives::transmittance},
     {"unscattered_transmittance", "unscattered",
      &AddingDoublingDerivatives::unscattered_transmittance}}};

struct Quantity {
  const char* key;
  const char* name;
  double LayerDerivatives::*derivative;
  double (*value)(const Layer&);
};
constexpr std::array<Quantity, 4> quantities = {
    {{"by_sigma_a", "sigma_a", &LayerDerivatives::by_sigma_a,
      [](const Layer& layer) { return layer.medium.sigma_a; }},
     {"by_sigma_s", "sigma_s", &LayerDerivatives::by_sigma_s,
      [](const Layer& layer) { return layer.medium.sigma_s; }},
     {"by_g", "g", &LayerDerivatives::by_g, [](const Layer& layer) { return layer.medium.g; }},
     {"by_thickness", "thickness", &LayerDerivatives::by_thickness,
      [](const Layer& layer) { return layer.thickness; }}}};

double total_of(const AddingDoublingDerivatives& band, const Total& total) {
  if (total.derivatives == &AddingDoublingDerivatives::diffuse_reflectance)
    return band.totals.totals.diffuse_reflectance;
  if (total.derivatives == &AddingDoublingDerivatives::transmittance)
    return band.totals.totals.transmittance;
  return band.totals.unscattered_transmittance;
}

}  // namespace

std::vector<AddingDoublingDerivatives> slab_derivatives(const Material& material,
                                                        const std::vector<LayerStack>& stacks,
                                                        const Incidence& incidence,
                                                        const AddingDoublingOptions& options) {
  std::vector<AddingDoublingDerivatives> bands(stacks.size());
  parallel_for(
      stacks.size(),
      [&](std::size_t b) {
        try {
          bands[b] = adding_doubling_derivatives(
              stacks[b], incidence, {.accuracy = options.accuracy, .max_nodes = options.max_nodes});
        } catch (const InvalidInput& refusal) {
          throw InvalidInput(fmt::format("--derivatives, band {}: {}", band_name(material.bands, b),
                                         refusal.what()));
        }
      },
      options.progress);
  return bands;
}

JsonOutput derivatives_json(const std::vector<AddingDoublingDerivatives>& bands) {
  JsonOutput json;
  for (const Total& total : totals)
    for (const Quantity& quantity : quantities) {
      JsonOutput layers = JsonOutput::array();
      for (std::size_t layer = 0; layer < (bands[0].*total.derivatives).size(); ++layer) {
        JsonOutput row;
        for (const AddingDoublingDerivatives& band : bands)
          row.push_back((band.*total.derivatives)[layer].*quantity.derivative);
        layers.push_back(row);
      }
      json[total.key][quantity.key] = layers;
    }
  return json;
}

std::string derivatives_text(const Material& material, const std::vector<LayerStack>& stacks,
                             const std::vector<AddingDoublingDerivatives>& bands) {
  std::string text = fmt::format("\n{:<36}", "% of a total by 1 % more of");
  for (std::size_t band = 0; band < bands.size(); ++band)
    text += fmt::format("  {:>8}", band_name(material.bands, band));
  for (const Total& total : totals) {
    if (std::ranges::all_of(bands, [&](const auto& band) { return total_of(band, total) <= 0.0; }))
      continue;
    for (std::size_t layer = 0; layer < material.layers.size(); ++layer)
      for (const Quantity& quantity : quantities) {
        const auto change = [&](std::size_t band) {
          const double value = quantity.value(stacks[band].layers()[layer]);
          const double derivative = (bands[band].*total.derivatives)[layer].*quantity.derivative;
          const double whole = total_of(bands[band], total);
          return std::isfinite(value) && whole > 0.0 ? derivative * value / whole : 0.0;
        };
        bool is_seen = false;
        for (std::size_t band = 0; band < bands.size(); ++band)
          is_seen = is_seen || change(band) != 0.0;
        if (!is_seen) continue;  // g of 0, thickness of a half-space
        const std::string& name = material.layers[layer].name;
        text += fmt::format(
            "\n{:<36}",
            fmt::format("{}: {}, {}", total.name,
                        name.empty() ? fmt::format("layer {}", layer) : name, quantity.name));
        for (std::size_t band = 0; band < bands.size(); ++band)
          text += fmt::format("  {:8.4f}", change(band));
      }
  }
  return text + "\n";
}

}  // namespace lamina::cli
