// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/base/io/json_output.h"
#include "lamina/skin/maps/skin_maps.h"

namespace lamina {

/// Standard deviations of what a map gives, in its coordinate: of ln(value + offset) of amounts,
/// with the offset of skin_fit_numbers; of the logit of shares.
struct SkinMapDeviation {
  std::string name;  ///< of the map
  Image values;      ///< of its size and channels, >= 0
};

/// A file that loads the maps: "patch.json" or "material.json", and what it says but for "skin".
struct MapsFile {
  std::string name;
  JsonOutput rest;
};

/// Skin that is made of maps, as `lamina maps` leaves it in a folder, ready to be edited.
struct EditableSkin {
  SkinMaps skin;
  double width_mm = 0.0;  ///< of what the maps cover; 0: not known, as over a mesh
  std::vector<SkinMapDeviation> deviations;
  Image mask;  ///< mask.exr: 1 where there is skin, 0 where there is none; empty: everywhere
  std::vector<MapsFile> files;  ///< one, or both kinds
};

/// @throws InvalidInput if an image has other proportions than the maps.
void require_alike(const std::string& what, const Image& image, const SkinMaps& skin);

/// A file that loads the maps, in one folder with them.
[[nodiscard]] JsonOutput maps_file_json(const EditableSkin& skin, const MapsFile& file);

/// Image in a folder beside that file: all maps and standard deviations.
struct NamedImage {
  std::string file;  ///< "melanin.exr"
  const Image* image;
};
[[nodiscard]] std::vector<NamedImage> images_of(const EditableSkin& skin);

}  // namespace lamina
