// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/skin/number_unit.h"

#include <array>
#include <string_view>
#include <utility>

namespace lamina {

std::string unit_of_number(const std::string& name) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 8> units = {{
      {"melanin",
       "volume fraction of the epidermis; eumelanin of 6.6e10 nm^-3.33 /mm, pheomelanin "
       "of 2.9e14 nm^-4.75 /mm"},
      {"melanin_blend", "share of eumelanin"},
      {"hemoglobin_epidermis", "volume fraction of whole blood, 150 g/L, in the epidermis"},
      {"hemoglobin_dermis", "volume fraction of whole blood, 150 g/L, in the dermis"},
      {"carotene", "volume fraction of a 1 g/L solution in the epidermis"},
      {"saturation", "share of hemoglobin with oxygen"},
      {"scattering_scale", "times the scattering of Donner et al. 2008, eq. 12"},
      {"baseline_scale", "times the absorption of skin without pigment, Jacques 1998"},
  }};
  for (const auto& [number, unit] : units)
    if (number == name) return std::string(unit);
  return "";
}

}  // namespace lamina
