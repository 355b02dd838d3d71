// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/base/io/json_input.h"
#include "lamina/skin/maps/material_maps.h"

namespace lamina {

/// Decodes one number that is a map, as base/image/map_description.h has the syntax. An image that
/// has the number's channels, one for each band, gives it by band unless a channel is named; of
/// others it is the first channel. Values outside the range are clamped, with a warning that counts
/// them.
/// @throws InvalidInput naming the field; FileError naming the first texel that is not finite.
[[nodiscard]] MaterialMap decode_material_map(const MappableNumber& number, const JsonInput& value,
                                              std::vector<std::string>& warnings);

/// Decodes a built-in material's name, the path of a material file, or what such a file holds; each
/// with numbers that may be maps.
/// @throws as decode_material, decode_material_map
[[nodiscard]] MappedMaterial decode_mapped_material(const JsonInput& value);

}  // namespace lamina
