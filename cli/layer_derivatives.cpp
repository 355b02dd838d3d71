// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "layer_derivatives.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "material_bands.h"

namespace lamina::cli {
namespace {

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

}  // namespace

JsonOutput layer_derivatives_json(std::size_t layers, const DerivativeJson& value) {
  JsonOutput json;
  for (const Quantity& quantity : quantities) {
    JsonOutput rows = JsonOutput::array();
    for (std::size_t layer = 0; layer < layers; ++layer)
      rows.push_back(value(layer, quantity.derivative));
    json[quantity.key] = rows;
  }
  return json;
}

std::string layer_derivatives_head(const std::string& of_what, const Material& material) {
  std::string text = fmt::format("{:<36}", "% of " + of_what + " by 1 % more of");
  for (std::size_t band = 0; band < material.bands.size(); ++band)
    text += fmt::format("  {:>8}", band_name(material.bands, band));
  return text;
}

std::string layer_derivatives_text(const std::string& name, const Material& material,
                                   const std::vector<LayerStack>& stacks,
                                   const std::vector<DifferentiatedNumber>& bands) {
  std::string text;
  if (std::ranges::all_of(bands, [](const auto& band) { return band.value <= 0.0; })) return text;
  for (std::size_t layer = 0; layer < material.layers.size(); ++layer)
    for (const Quantity& quantity : quantities) {
      const auto change = [&](std::size_t band) {
        const double value = quantity.value(stacks[band].layers()[layer]);
        const double derivative = (*bands[band].derivatives)[layer].*quantity.derivative;
        const double whole = bands[band].value;
        return std::isfinite(value) && whole > 0.0 ? derivative * value / whole : 0.0;
      };
      bool is_seen = false;
      for (std::size_t band = 0; band < bands.size(); ++band)
        is_seen = is_seen || change(band) != 0.0;
      if (!is_seen) continue;  // g of 0, thickness of a half-space
      const std::string& layer_name = material.layers[layer].name;
      text += fmt::format(
          "\n{:<36}", fmt::format("{}: {}, {}", name,
                                  layer_name.empty() ? fmt::format("layer {}", layer) : layer_name,
                                  quantity.name));
      for (std::size_t band = 0; band < bands.size(); ++band)
        text += fmt::format("  {:8.4f}", change(band));
    }
  return text;
}

}  // namespace lamina::cli
