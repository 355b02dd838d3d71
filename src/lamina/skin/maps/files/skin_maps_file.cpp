// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/files/skin_maps_file.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lamina/base/io/json_input.h"
#include "lamina/layers/materials/material_file.h"
#include "lamina/skin/maps/files/material_map_file.h"

namespace lamina {

std::pair<int, int> patch_size(const JsonObject& patch, const Image* first) {
  constexpr int largest_side = 16384;
  const auto width = patch.optional("width"), height = patch.optional("height");
  const auto side = [](const std::optional<JsonInput>& given) {
    return given ? static_cast<int>(given->integer(1, largest_side)) : 0;
  };
  if (!first || (width && height))
    return {side(patch.required("width")), side(patch.required("height"))};
  if (!width && !height) return {first->width, first->height};
  const double aspect = static_cast<double>(first->width) / first->height;
  const auto other = [](double length) {
    return std::max(1, static_cast<int>(std::lround(length)));
  };
  if (width) return {side(width), other(side(width) / aspect)};
  return {other(side(height) * aspect), side(height)};
}

SkinMaps decode_skin_maps(const JsonInput& recipe, std::span<const std::string> channels) {
  SkinMaps result;
  material_file::Context context{.length_unit = "mm"};
  context.channels.assign(channels.begin(), channels.end());
  context.maps = [&](const MappableNumber& number, const JsonInput& value) {
    MaterialMap map = decode_material_map(number, value, result.warnings);
    std::vector<double> means = means_of(map);
    if (number.of == MappableNumber::Of::skin) {
      const SkinParameterRange& range = skin_parameter_ranges()[number.part];
      result.maps.push_back({std::string(range.name), range.value, std::move(map.values)});
    } else if (number.of == MappableNumber::Of::ink) {
      result.maps.push_back({"", nullptr, std::move(map.values), number.part});
    } else {
      result.others.push_back(std::move(map));
    }
    return means;
  };
  material_file::DecodedSkin decoded = material_file::decode_skin_recipe(recipe, context);
  result.skin = std::move(decoded.recipe.skin);
  result.constants = decoded.recipe.constants;
  result.oiliness = decoded.oiliness;
  for (SkinMap& map : result.maps)
    if (!map.parameter) map.name = "ink_" + ink_name(result.skin, map.ink);
  return result;
}

}  // namespace lamina
