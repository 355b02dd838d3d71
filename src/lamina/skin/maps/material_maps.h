// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/base/image/image.h"
#include "lamina/layers/materials/material.h"

namespace lamina {

/// A number of a material that is an image: one channel, or one for each band, of any size, every
/// value in the number's range, in mm.
struct MaterialMap {
  MappableNumber number;
  Image values;
};

/// The mean of each channel.
[[nodiscard]] std::vector<double> means_of(const MaterialMap& map);

/// A material that differs from place to place. What maps give has its mean in the material.
struct MappedMaterial {
  Material material;
  std::vector<MaterialMap> maps;
  std::vector<std::string> warnings;  ///< what was clamped, in the user's words
};

}  // namespace lamina
