// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/materials/material_file.h"
#include "lamina/materials/skin.h"

namespace lamina::material_file {
namespace {

/// The name of the set of constants, and the parameters that start from it.
std::pair<std::string, SkinParameters> decode_constants(const JsonObject& skin) {
  const auto given = skin.optional("constants");
  if (!given) return {"calibrated", with_constants({}, SkinConstants::calibrated)};
  const auto constants =
      given->choice<SkinConstants>({{"paper", SkinConstants::paper},
                                    {"calibrated", SkinConstants::calibrated},
                                    {"calibrated_diffusion", SkinConstants::calibrated_diffusion}});
  return {given->string(), with_constants({}, constants)};
}

}  // namespace

void decode_skin(const JsonInput& recipe, const Context& context, Material& material) {
  const JsonObject object =
      recipe.object({"melanin", "melanin_blend", "hemoglobin_epidermis", "hemoglobin_dermis",
                     "carotene", "saturation_epidermis", "saturation_dermis", "baseline_scale",
                     "scattering_scale", "scattering_power", "epidermis_thickness",
                     "junction_absorption", "dermis_thickness", "oiliness", "constants"});
  require_wavelengths(recipe, context, 350.0, 1000.0);
  auto [constants, skin] = decode_constants(object);
  for (const SkinParameterRange& range : skin_parameter_ranges())
    if (const auto value = object.optional(range.name))
      skin.*range.value = range.is_length ? recipe_length(*value, range.low, range.high, context)
                                          : recipe_number(*value, between(range.low, range.high));
  if (const auto oiliness = object.optional("oiliness"))
    material.oiliness = recipe_number(*oiliness, between(0.0, 1.0));
  std::vector<LayerStack> bands;
  for (const double wavelength : context.wavelengths)
    bands.push_back(skin_layer_stack(skin, wavelength));
  material.layers = material_layers(bands, skin_layer_names(skin));
  add_to_source(material, "melanin: Jacques 1998; constants: " + constants);
}

}  // namespace lamina::material_file
