// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "fit_units.h"

#include <algorithm>
#include <array>
#include <utility>

namespace lamina::cli {

std::string unit_of(std::string_view path, std::string_view length_unit) {
  constexpr auto recipe_units =
      std::to_array<std::pair<std::string_view, std::string_view>>({{"leaf.chlorophyll", "µg/cm²"},
                                                                    {"leaf.carotenoids", "µg/cm²"},
                                                                    {"leaf.anthocyanins", "µg/cm²"},
                                                                    {"leaf.water", "cm"},
                                                                    {"leaf.dry_matter", "g/cm²"},
                                                                    {"snow.density", "kg/m³"},
                                                                    {"snow.soot", "ppm by mass"},
                                                                    {"snow.dust", "ppm by mass"}});
  const auto* known =
      std::ranges::find(recipe_units, path, &std::pair<std::string_view, std::string_view>::first);
  if (known != recipe_units.end()) return std::string(known->second);
  const std::string_view amplitude = path.ends_with(".a") ? path.substr(0, path.size() - 2) : path;
  for (const std::string_view coefficient : {".sigma_a", ".sigma_s", ".sigma_s_prime"})
    if (amplitude.ends_with(coefficient)) return "1/" + std::string(length_unit);
  for (const std::string_view length : {"thickness", "radius", "diameter"})
    if (path.ends_with(length)) return std::string(length_unit);
  return "";
}

}  // namespace lamina::cli
