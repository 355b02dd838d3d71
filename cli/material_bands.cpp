// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "material_bands.h"

#include <nlohmann/json.hpp>

namespace lamina::cli {

std::vector<LayerStack> layer_stacks(const Material& material) {
  std::vector<LayerStack> stacks;
  for (std::size_t band = 0; band < material.bands.size(); ++band)
    stacks.push_back(layer_stack(material, band));
  return stacks;
}

nlohmann::ordered_json bands_json(const BandSet& bands) {
  auto list = nlohmann::ordered_json::array();
  for (std::size_t band = 0; band < bands.size(); ++band) {
    if (bands.is_rgb())
      list.push_back(band_name(bands, band));
    else
      list.push_back(bands.wavelengths()[band]);
  }
  return list;
}

nlohmann::ordered_json table_json(std::span<const double> table, std::size_t columns) {
  auto rows = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < table.size(); i += columns)
    rows.push_back(std::vector<double>(table.begin() + static_cast<std::ptrdiff_t>(i),
                                       table.begin() + static_cast<std::ptrdiff_t>(i + columns)));
  return rows;
}

}  // namespace lamina::cli
