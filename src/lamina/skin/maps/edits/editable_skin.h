// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lamina/base/core/memory_budget.h"
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

/// Reads a folder with a patch.json or a material.json (with both the maps are those of the patch),
/// or such a file; of the maps NAME.exr also their standard deviations, NAME.sd.exr, where these
/// lie beside them (saturation.sd.exr is that of both saturations), and where there is skin,
/// mask.exr. What such a file says that names further images is left out, with a warning.
/// @throws FileError if there is none or an image is unreadable or not finite; InvalidInput naming
///         file, line and field.
[[nodiscard]] EditableSkin load_editable_skin(const std::filesystem::path& file_or_folder,
                                              MemoryBudget memory = {});

/// A file that loads the maps, in one folder with them.
[[nodiscard]] JsonOutput maps_file_json(const EditableSkin& skin, const MapsFile& file);

/// Image in a folder beside that file: all maps and standard deviations.
struct NamedImage {
  std::string file;  ///< "melanin.exr"
  const Image* image;
};
[[nodiscard]] std::vector<NamedImage> images_of(const EditableSkin& skin);

/// Writes maps, standard deviations and mask into a folder, and then the files that load the maps.
/// Images say in their headers what their numbers are, and "lamina.edited_from". Standard
/// deviations that lie there of maps that have none now are removed.
///
/// @param version  of lamina
/// @throws WriteError
void save_editable_skin(const EditableSkin& skin, const std::filesystem::path& folder,
                        const std::string& version, const std::string& edited_from);

}  // namespace lamina
