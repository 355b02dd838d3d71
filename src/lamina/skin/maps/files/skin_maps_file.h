// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <utility>

#include "lamina/skin/maps/skin_maps.h"

namespace lamina {

class JsonInput;
class JsonObject;

/// Decodes the recipe; lengths are in mm. A map is an image that
/// base/image/map_description.h has the syntax of, of its first channel unless one is named.
///
/// Values outside the parameter's range are clamped, with a warning that counts them.
/// @param channels  one for each band: an image that has them gives the absorption of the junction
///                  by band
/// @throws InvalidInput naming the field; FileError naming the first texel that is not finite.
[[nodiscard]] SkinMaps decode_skin_maps(const JsonInput& recipe,
                                        std::span<const std::string> channels = {});

/// "width" and "height" of a patch in texels: as given, else those of the first map, whose
/// proportions one given side keeps. @throws InvalidInput
///
/// @param first  null: there is no map
[[nodiscard]] std::pair<int, int> patch_size(const JsonObject& patch, const Image* first);

}  // namespace lamina
