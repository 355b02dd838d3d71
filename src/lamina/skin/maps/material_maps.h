// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/base/image/image.h"
#include "lamina/layers/materials/material.h"

namespace lamina {

class JsonInput;

/// A number of a material that is an image: one channel, or one for each band, of any size, every
/// value in the number's range, in mm.
struct MaterialMap {
  MappableNumber number;
  Image values;
};

/// Decodes one number that is a map, as base/image/map_description.h has the syntax. An image that has
/// the number's channels, one for each band, gives it by band unless a channel is named; of others
/// it is the first channel. Values outside the range are clamped, with a warning that counts them.
/// @throws InvalidInput naming the field; FileError naming the first texel that is not finite.
[[nodiscard]] MaterialMap decode_material_map(const MappableNumber& number, const JsonInput& value,
                                              std::vector<std::string>& warnings);

/// The mean of each channel.
[[nodiscard]] std::vector<double> means_of(const MaterialMap& map);

/// A material that differs from place to place. What maps give has its mean in the material.
struct MappedMaterial {
  Material material;
  std::vector<MaterialMap> maps;
  std::vector<std::string> warnings;  ///< what was clamped, in the user's words
};

/// Decodes a built-in material's name, the path of a material file, or what such a file holds; each
/// with numbers that may be maps.
/// @throws as decode_material, decode_material_map
[[nodiscard]] MappedMaterial decode_mapped_material(const JsonInput& value);

}  // namespace lamina
