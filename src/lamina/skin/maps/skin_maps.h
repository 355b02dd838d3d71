// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/base/image/image.h"
#include "lamina/layers/materials/skin.h"
#include "lamina/skin/maps/material_maps.h"

namespace lamina {

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

/// The first map, null if there is none.
[[nodiscard]] const Image* first_map(const SkinMaps& skin);

}  // namespace lamina
