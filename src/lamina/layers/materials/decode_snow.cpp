// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/materials/material_file.h"
#include "lamina/layers/materials/snow.h"

namespace lamina::material_file {

void decode_snow(const JsonInput& recipe, const Context& context, Material& material) {
  const JsonObject object = recipe.object({"grain_radius", "density", "soot", "dust", "thickness"});
  require_wavelengths(recipe, context, 380.0, 1000.0);
  SnowParameters snow;
  for (const SnowParameterRange& range : snow_parameter_ranges())
    if (const auto value = object.optional(range.name))
      snow.*range.value = range.is_length
                              ? plain_length(*value, range.low, range.high, context)
                              : plain_number(*value, closed_interval(range.low, range.high));
  std::vector<LayerStack> bands;
  for (const double wavelength : context.wavelengths)
    bands.push_back(snow_layer_stack(snow, wavelength));
  material.layers = material_layers(bands, {"snow"});
  add_to_source(material, "ice: Warren & Brandt 2008");
}

}  // namespace lamina::material_file
