// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lamina/core/json_input.h"
#include "lamina/materials/material.h"

// What the decoders of a material file share: one for `layers`, one per recipe.

namespace lamina {

/// A material file as a value, as in a scene that holds the whole of it.
/// @throws InvalidInput as parse_material.
[[nodiscard]] Material decode_material(const JsonInput& root);

}  // namespace lamina

namespace lamina::material_file {

/// What the rest of the file says about its numbers.
struct Context {
  std::size_t bands = 0;     ///< how many numbers stand for a quantity per band
  std::string length_unit;   ///< as written: "mm", "cm", "um" or "m"
  double mm_per_unit = 1.0;  ///< the length of that unit
};

/// Coefficients beyond this [1/mm] and lengths beyond this [mm] are taken for mistakes; so are
/// indices outside [0.1, 10].
inline constexpr double largest_number = 1e9;

/// The array `layers`. @throws InvalidInput
[[nodiscard]] std::vector<MaterialLayer> decode_layers(const JsonInput& layers,
                                                       const Context& context);

/// A boundary's keys "roughness" and "distribution". @throws InvalidInput
[[nodiscard]] Interface decode_interface(const JsonObject& object);

/// A refractive index, one number or one per band.
[[nodiscard]] std::vector<double> decode_ior(const JsonInput& value, const Context& context);

}  // namespace lamina::material_file
