// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/mapped_skin_json.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace lamina {

JsonOutput mapped_skin_json(const SkinMaps& base, std::span<const SkinMap> maps) {
  const auto has_map = [&](const std::string& name) {
    return std::ranges::find(maps, name, &SkinMap::name) != maps.end();
  };
  const auto map_json = [](const std::string& name) { return JsonOutput{{"map", name + ".exr"}}; };
  JsonOutput skin;
  skin["constants"] = name_of(base.constants);
  for (const SkinParameterRange& range : skin_parameter_ranges()) {
    const std::string name(range.name);
    const double value = base.skin.*range.value;
    if (has_map(name))
      skin[name] = map_json(name);
    else if (std::isfinite(value))
      skin[name] = value;
  }
  if (!base.skin.junction_spectrum.empty()) skin["junction_spectrum"] = base.skin.junction_spectrum;
  for (std::size_t i = 0; i < base.skin.inks.size(); ++i) {
    const SkinInk& from = base.skin.inks[i];
    const std::string name = "ink_" + ink_name(base.skin, i);
    JsonOutput ink;
    ink["name"] = ink_name(base.skin, i);
    ink["absorbance"] = has_map(name) ? map_json(name) : JsonOutput(from.absorbance);
    if (!from.spectrum.empty()) ink["spectrum"] = from.spectrum;
    skin["inks"].push_back(std::move(ink));
  }
  if (!base.others.empty())
    skin["oiliness"] = map_json("oiliness");
  else if (base.oiliness > 0.0)
    skin["oiliness"] = base.oiliness;
  return skin;
}

}  // namespace lamina
