// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "slab_derivatives.h"

#include <fmt/core.h>

#include <array>
#include <cstddef>

#include "lamina/base/core/error.h"
#include "lamina/base/core/progress.h"
#include "layer_derivatives.h"

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
    json[total.key] =
        layer_derivatives_json((bands[0].*total.derivatives).size(),
                               [&](std::size_t layer, double LayerDerivatives::*derivative) {
                                 JsonOutput row;
                                 for (const AddingDoublingDerivatives& band : bands)
                                   row.push_back((band.*total.derivatives)[layer].*derivative);
                                 return row;
                               });
  return json;
}

std::string derivatives_text(const Material& material, const std::vector<LayerStack>& stacks,
                             const std::vector<AddingDoublingDerivatives>& bands) {
  std::string text = "\n" + layer_derivatives_head("a total", material);
  for (const Total& total : totals) {
    std::vector<DifferentiatedNumber> of_bands;
    for (const AddingDoublingDerivatives& band : bands)
      of_bands.push_back({total_of(band, total), &(band.*total.derivatives)});
    text += layer_derivatives_text(total.name, material, stacks, of_bands);
  }
  return text + "\n";
}

}  // namespace lamina::cli
