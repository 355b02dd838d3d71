// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lamina/image/image.h"
#include "lamina/materials/skin.h"

namespace lamina {

class JsonInput;
class JsonObject;

/// A parameter of skin that is an image: one channel, of any size, every value in the parameter's
/// range.
struct SkinMap {
  std::string_view name;  ///< as in skin_parameter_ranges
  double SkinParameters::* parameter;
  Image values;
};

/// Skin that differs from place to place: a recipe "skin" whose parameters are numbers or maps.
struct SkinMaps {
  SkinParameters skin;  ///< what no map gives
  SkinConstants constants = SkinConstants::calibrated;
  double oiliness = 0.0;
  std::vector<SkinMap> maps;
  std::vector<std::string> warnings;  ///< what was clamped, in the user's words
};

/// Decodes the recipe; lengths are in mm. A map is an image that
/// image/map_description.h has the syntax of, of its first channel unless one is named. Only what colours the layers may be a map:
/// scattering, thickness and oiliness are numbers.
///
/// Values outside the parameter's range are clamped, with a warning that counts them.
/// @throws InvalidInput naming the field; FileError naming the first texel that is not finite.
[[nodiscard]] SkinMaps decode_skin_maps(const JsonInput& recipe);

/// Decodes one parameter that is a map, and adds a warning if values were clamped.
/// @throws as decode_skin_maps.
[[nodiscard]] SkinMap decode_skin_map(const SkinParameterRange& range, const JsonInput& value,
                                      std::vector<std::string>& warnings);

/// "width" and "height" of a patch in texels: as given, else those of the first map, whose
/// proportions one given side keeps. @throws InvalidInput
[[nodiscard]] std::pair<int, int> patch_size(const JsonObject& patch,
                                             std::span<const SkinMap> maps);

/// Whether a parameter of that name may be a map.
[[nodiscard]] bool may_be_map(std::string_view parameter);

}  // namespace lamina
