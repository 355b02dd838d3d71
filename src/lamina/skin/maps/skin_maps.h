// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/image/image.h"
#include "lamina/layers/materials/skin.h"
#include "lamina/skin/maps/material_maps.h"

namespace lamina {

class JsonInput;
class JsonObject;

/// A parameter of skin, or the absorbance of one of its inks, that is an image of any size, every
/// value in the parameter's range. It has one channel; what the junction absorbs may have one for
/// each band.
struct SkinMap {
  std::string name;  ///< as in skin_parameter_ranges; of an ink "ink_" and its name
  double SkinParameters::*parameter;  ///< null: of an ink
  Image values;
  std::size_t ink = 0;  ///< which one, where there is no parameter
};

/// Number of skin that a map gives, in skin that has its ink.
[[nodiscard]] double& mapped_number(SkinParameters& skin, const SkinMap& map);

/// Name of an ink in maps and files: its name, or its place.
[[nodiscard]] std::string ink_name(const SkinParameters& skin, std::size_t ink);

/// Skin that differs from place to place: a recipe "skin" whose numbers may be maps.
struct SkinMaps {
  SkinParameters skin;  ///< what no map gives
  SkinConstants constants = SkinConstants::calibrated;
  double oiliness = 0.0;
  std::vector<SkinMap> maps;
  std::vector<MaterialMap> others;    ///< of oil
  std::vector<std::string> warnings;  ///< what was clamped, in the user's words
};

/// Decodes the recipe; lengths are in mm. A map is an image that
/// base/image/map_description.h has the syntax of, of its first channel unless one is named.
///
/// Values outside the parameter's range are clamped, with a warning that counts them.
/// @param channels  one for each band: an image that has them gives the absorption of the junction
/// by
///                  band
/// @throws InvalidInput naming the field; FileError naming the first texel that is not finite.
[[nodiscard]] SkinMaps decode_skin_maps(const JsonInput& recipe,
                                        std::span<const std::string> channels = {});

/// "width" and "height" of a patch in texels: as given, else those of the first map, whose
/// proportions one given side keeps. @throws InvalidInput
///
/// @param first  null: there is no map
[[nodiscard]] std::pair<int, int> patch_size(const JsonObject& patch, const Image* first);

/// The first map, null if there is none.
[[nodiscard]] const Image* first_map(const SkinMaps& skin);

}  // namespace lamina
