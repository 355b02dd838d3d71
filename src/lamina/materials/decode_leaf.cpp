// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/materials/leaf.h"
#include "lamina/materials/material_file.h"

namespace lamina::material_file {

void decode_leaf(const JsonInput& recipe, const Context& context, Material& material) {
  const JsonObject object =
      recipe.object({"chlorophyll", "carotenoids", "anthocyanins", "brown_pigments", "water",
                     "dry_matter", "structure", "palisade_share", "thickness"});
  require_wavelengths(recipe, context, 400.0, 800.0);
  LeafParameters leaf;
  for (const LeafParameterRange& range : leaf_parameter_ranges())
    if (const auto value = object.optional(range.name))
      leaf.*range.value = range.is_length
                              ? recipe_length(*value, range.low, range.high, context)
                              : recipe_number(*value, closed_interval(range.low, range.high));
  std::vector<LayerStack> bands;
  for (const double wavelength : context.wavelengths)
    bands.push_back(leaf_layer_stack(leaf, wavelength));
  material.layers = material_layers(bands, {"palisade", "spongy"});
  add_to_source(material, "absorption: PROSPECT-D");
}

}  // namespace lamina::material_file
