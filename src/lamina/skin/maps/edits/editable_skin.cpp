// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/edits/editable_skin.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/skin/maps/mapped_skin_json.h"

namespace lamina {
namespace {

std::string size_text(const Image& image) {
  return std::to_string(image.width) + " x " + std::to_string(image.height);
}

/// Same proportions, but for the rounding of sides to whole texels.
bool are_alike(const Image& a, const Image& b) {
  const double across = static_cast<double>(a.width) * b.height;
  const double down = static_cast<double>(a.height) * b.width;
  const double rounding = 0.01 * std::max(across, down) + std::max(b.width, b.height);
  return std::abs(across - down) <= rounding;
}

}  // namespace

void require_alike(const std::string& what, const Image& image, const SkinMaps& skin) {
  const Image* map = first_map(skin);
  if (map && !are_alike(image, *map))
    throw InvalidInput(what + " must have the proportions of the maps, " + size_text(*map) +
                       ", but is " + size_text(image));
}

JsonOutput maps_file_json(const EditableSkin& skin, const MapsFile& file) {
  JsonOutput json = file.rest;
  json["skin"] = mapped_skin_json(skin.skin, skin.skin.maps);
  return json;
}

std::vector<NamedImage> images_of(const EditableSkin& skin) {
  std::vector<NamedImage> images;
  for (const SkinMap& map : skin.skin.maps) images.push_back({map.name + ".exr", &map.values});
  for (const MaterialMap& map : skin.skin.others) images.push_back({"oiliness.exr", &map.values});
  for (const SkinMapDeviation& deviation : skin.deviations)
    images.push_back({deviation.name + ".sd.exr", &deviation.values});
  if (!skin.mask.pixels.empty()) images.push_back({"mask.exr", &skin.mask});
  return images;
}

}  // namespace lamina
