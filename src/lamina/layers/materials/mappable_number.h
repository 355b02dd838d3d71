// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace lamina {

class JsonInput;

/// A number of a material that files of patches and scenes may give as a map, {"map": FILE}.
struct MappableNumber {
  enum class Of {
    skin,       ///< a number of the recipe; `part` is its place among skin_parameter_ranges
    ink,        ///< absorbance of one of the recipe's inks, of place `part`
    leaf,       ///< a number of the recipe; `part` is its place among leaf_parameter_ranges
    sigma_a,    ///< [1/mm], of the substance that fills what a mixture leaves
    sigma_s,    ///< [1/mm], likewise
    g,          ///< likewise
    thickness,  ///< [mm] of a layer
    fraction,   ///< of part `part` of a layer's mixture
    roughness,  ///< of the lit surface
    oiliness,
  };
  Of of = Of::thickness;
  std::size_t layer = 0, part = 0;
  std::string name;  ///< as files say it, "skin.melanin" or "layers[1].sigma_a"
  double low = 0.0;  ///< the closed range of values, lengths in mm
  double high = 0.0;
  double unit = 1.0;  ///< factor from the file's unit
  /// Channels that an image has which gives one value per band; empty: one for all bands
  std::vector<std::string> channels = {};
};

/// Takes a number that is a map and returns its mean, or its means by band where it has some.
using MaterialMaps =
    std::function<std::vector<double>(const MappableNumber& number, const JsonInput& map)>;

}  // namespace lamina
