// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/materials/leaf.h"
#include "lamina/layers/materials/material_file.h"

namespace lamina::material_file {

void decode_leaf(const JsonInput& recipe, const Context& context, Material& material) {
  const JsonObject object =
      recipe.object({"chlorophyll", "carotenoids", "anthocyanins", "brown_pigments", "water",
                     "dry_matter", "structure", "palisade_share", "thickness"});
  require_wavelengths(recipe, context, shortest_leaf_wavelength, longest_leaf_wavelength);
  LeafParameters leaf;
  for (const LeafParameterRange& range : leaf_parameter_ranges())
    if (const auto value = object.optional(range.name)) {
      const MappableNumber number{
          .of = MappableNumber::Of::leaf,
          .part = static_cast<std::size_t>(&range - leaf_parameter_ranges().data()),
          .name = "leaf." + std::string(range.name),
          .low = range.low,
          .high = range.high};
      leaf.*range.value = range.is_length ? mappable_length(*value, number, context)
                                          : mappable_number(*value, number, context);
    }
  std::vector<LayerStack> bands;
  for (const double wavelength : context.wavelengths)
    bands.push_back(leaf_layer_stack(leaf, wavelength));
  material.layers = material_layers(bands, {"palisade", "spongy"});
  material.leaf = leaf;
  add_to_source(material, "absorption: PROSPECT-D");
}

}  // namespace lamina::material_file
