// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/materials/material_file.h"
#include "lamina/materials/skin.h"

namespace lamina::material_file {
JsonObject skin_object(const JsonInput& recipe) {
  return recipe.object({"melanin", "melanin_blend", "hemoglobin_epidermis", "hemoglobin_dermis",
                        "carotene", "saturation_epidermis", "saturation_dermis", "baseline_scale",
                        "scattering_scale", "scattering_power", "epidermis_thickness",
                        "junction_absorption", "junction_spectrum", "dermis_thickness", "oiliness",
                        "constants"});
}

std::vector<std::array<double, 2>> decode_junction_spectrum(const JsonObject& skin) {
  std::vector<std::array<double, 2>> points;
  const auto given = skin.optional("junction_spectrum");
  if (!given) return points;
  for (const JsonInput& pair : given->array(1, 1000)) {
    const std::vector<JsonInput> both = pair.array(2, 2);
    const double nm = both[0].number(closed_interval(350.0, 1000.0, "nm"));
    if (!points.empty() && nm <= points.back()[0])
      both[0].refuse("must be greater than the wavelength before it");
    points.push_back({nm, both[1].number(closed_interval(0.0, 1.0))});
  }
  return points;
}

SkinConstants decode_constants(const JsonObject& skin) {
  const auto given = skin.optional("constants");
  return given ? given->choice<SkinConstants>() : SkinConstants::calibrated;
}

void decode_skin(const JsonInput& recipe, const Context& context, Material& material) {
  const JsonObject object = skin_object(recipe);
  require_wavelengths(recipe, context, 350.0, 1000.0);
  const SkinConstants constants = decode_constants(object);
  SkinRecipe said{.skin = with_constants({}, constants), .constants = constants};
  SkinParameters& skin = said.skin;
  skin.junction_spectrum = decode_junction_spectrum(object);
  for (const SkinParameterRange& range : skin_parameter_ranges()) {
    const auto value = object.optional(range.name);
    if (!value) continue;
    if (context.maps && value->is_object()) {
      skin.*range.value = context.maps(range, *value);
    } else {
      skin.*range.value = range.is_length
                              ? recipe_length(*value, range.low, range.high, context)
                              : recipe_number(*value, closed_interval(range.low, range.high));
    }
  }
  if (const auto oiliness = object.optional("oiliness"))
    material.oiliness = recipe_number(*oiliness, closed_interval(0.0, 1.0));
  material.layers = skin_layers(skin, context.wavelengths);
  material.skin = std::move(said);
  add_to_source(material, "melanin: Jacques 1998; constants: " + std::string(name_of(constants)));
}

}  // namespace lamina::material_file

namespace lamina {

std::vector<MaterialLayer> skin_layers(const SkinParameters& skin,
                                       std::span<const double> wavelengths) {
  std::vector<LayerStack> bands;
  for (const double wavelength : wavelengths) bands.push_back(skin_layer_stack(skin, wavelength));
  return material_file::material_layers(bands, skin_layer_names(skin));
}

}  // namespace lamina
