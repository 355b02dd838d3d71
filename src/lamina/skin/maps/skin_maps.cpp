// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/skin_maps.h"

#include <string>

namespace lamina {

double& mapped_number(SkinParameters& skin, const SkinMap& map) {
  return map.parameter ? skin.*map.parameter : skin.inks[map.ink].absorbance;
}

std::string ink_name(const SkinParameters& skin, std::size_t ink) {
  const std::string& name = skin.inks[ink].name;
  return name.empty() ? std::to_string(ink) : name;
}

const Image* first_map(const SkinMaps& skin) {
  if (!skin.maps.empty()) return &skin.maps.front().values;
  return skin.others.empty() ? nullptr : &skin.others.front().values;
}

}  // namespace lamina
