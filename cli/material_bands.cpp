// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "material_bands.h"

namespace lamina::cli {

JsonOutput bands_json(const BandSet& bands) {
  auto list = JsonOutput::array();
  for (std::size_t band = 0; band < bands.size(); ++band) {
    if (bands.is_rgb())
      list.push_back(band_name(bands, band));
    else
      list.push_back(bands.wavelengths()[band]);
  }
  return list;
}

JsonOutput table_json(std::span<const double> table, std::size_t columns) {
  auto rows = JsonOutput::array();
  for (std::size_t i = 0; i < table.size(); i += columns)
    rows.push_back(std::vector<double>(table.begin() + static_cast<std::ptrdiff_t>(i),
                                       table.begin() + static_cast<std::ptrdiff_t>(i + columns)));
  return rows;
}

}  // namespace lamina::cli
