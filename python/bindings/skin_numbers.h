// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>

#include "arrays.h"
#include "choices.h"
#include "images.h"
#include "lamina/base/core/error.h"
#include "lamina/skin/maps/skin_maps.h"

namespace lamina::python {

/// Skin of arrays (height, width) and numbers, both by the names of skin_parameter_ranges.
[[nodiscard]] inline SkinMaps skin_maps_of(const py::dict& maps, const py::dict& numbers,
                                           const std::string& constants) {
  SkinMaps skin;
  skin.constants = choice<SkinConstants>(constants);
  skin.skin = with_constants(SkinParameters{}, skin.constants);
  const auto range_of = [](const py::handle& name) -> const SkinParameterRange& {
    const auto ranges = skin_parameter_ranges();
    const auto found =
        std::ranges::find(ranges, name.cast<std::string>(), &SkinParameterRange::name);
    if (found == ranges.end()) throw InvalidInput("there is no such parameter of skin");
    return *found;
  };
  for (const auto& [name, value] : numbers) skin.skin.*range_of(name).value = value.cast<double>();
  for (const auto& [name, value] : maps) {
    const SkinParameterRange& range = range_of(name);
    skin.maps.push_back({std::string(range.name), range.value, plane_image(value.cast<Floats>())});
  }
  return skin;
}

/// All numbers of skin by their names.
[[nodiscard]] inline py::dict numbers_dict(const SkinParameters& skin) {
  py::dict numbers;
  for (const SkinParameterRange& range : skin_parameter_ranges())
    numbers[std::string(range.name).c_str()] = skin.*range.value;
  return numbers;
}

}  // namespace lamina::python
