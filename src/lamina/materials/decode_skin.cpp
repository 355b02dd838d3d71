// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "lamina/materials/material_file.h"
#include "lamina/materials/skin.h"

namespace lamina::material_file {
namespace {

JsonObject skin_object(const JsonInput& recipe) {
  return recipe.object({"melanin", "melanin_blend", "hemoglobin_epidermis", "hemoglobin_dermis",
                        "carotene", "saturation_epidermis", "saturation_dermis", "baseline_scale",
                        "scattering_scale", "scattering_power", "epidermis_thickness",
                        "junction_absorption", "junction_spectrum", "inks", "dermis_thickness",
                        "oiliness", "constants"});
}

/// Pairs of a wavelength and a factor.
std::vector<std::array<double, 2>> decode_spectrum(const JsonInput& given) {
  std::vector<std::array<double, 2>> points;
  for (const JsonInput& pair : given.array(1, 1000)) {
    const std::vector<JsonInput> both = pair.array(2, 2);
    const double nm = both[0].number(closed_interval(350.0, 1000.0, "nm"));
    if (!points.empty() && nm <= points.back()[0])
      both[0].refuse("must be greater than the wavelength before it");
    points.push_back({nm, both[1].number(closed_interval(0.0, 1.0))});
  }
  return points;
}

std::vector<SkinInk> decode_inks(const JsonInput& given, const Context& context) {
  std::vector<SkinInk> inks;
  for (const JsonInput& value : given.array(1, 16)) {
    const JsonObject object = value.object({"name", "absorbance", "spectrum"});
    SkinInk ink;
    if (const auto name = object.optional("name")) {
      ink.name = name->string();
      if (ink.name.find_first_of("/\\") != std::string::npos)
        name->refuse("must not have slashes, for files are named after it");
      if (std::ranges::find(inks, ink.name, &SkinInk::name) != inks.end())
        name->fail("is the name of another ink");
    }
    ink.absorbance =
        mappable_number(object.required("absorbance"),
                        {.of = MappableNumber::Of::ink,
                         .part = inks.size(),
                         .name = "skin.inks[" + std::to_string(inks.size()) + "].absorbance",
                         .low = 0.0,
                         .high = largest_absorbance},
                        context);
    if (const auto spectrum = object.optional("spectrum"))
      ink.spectrum = decode_spectrum(*spectrum);
    inks.push_back(std::move(ink));
  }
  return inks;
}

}  // namespace

DecodedSkin decode_skin_recipe(const JsonInput& recipe, const Context& context) {
  const JsonObject object = skin_object(recipe);
  DecodedSkin decoded;
  if (const auto constants = object.optional("constants"))
    decoded.recipe.constants = constants->choice<SkinConstants>();
  SkinParameters& skin = decoded.recipe.skin;
  skin = with_constants({}, decoded.recipe.constants);
  if (const auto spectrum = object.optional("junction_spectrum"))
    skin.junction_spectrum = decode_spectrum(*spectrum);
  for (const SkinParameterRange& range : skin_parameter_ranges()) {
    const auto value = object.optional(range.name);
    if (!value) continue;
    MappableNumber number{.of = MappableNumber::Of::skin,
                          .part = static_cast<std::size_t>(&range - skin_parameter_ranges().data()),
                          .name = "skin." + std::string(range.name),
                          .low = range.low,
                          .high = range.high};
    if (range.value == &SkinParameters::junction_absorption) number.channels = context.channels;
    skin.*range.value = range.is_length ? mappable_length(*value, number, context)
                                        : mappable_number(*value, number, context);
  }
  if (const auto inks = object.optional("inks")) skin.inks = decode_inks(*inks, context);
  if (const auto oiliness = object.optional("oiliness"))
    decoded.oiliness = mappable_number(
        *oiliness,
        {.of = MappableNumber::Of::oiliness, .name = "skin.oiliness", .low = 0.0, .high = 1.0},
        context);
  return decoded;
}

void decode_skin(const JsonInput& recipe, const Context& context, Material& material) {
  DecodedSkin decoded = decode_skin_recipe(recipe, context);
  require_wavelengths(recipe, context, 350.0, 1000.0);
  material.oiliness = decoded.oiliness;
  material.layers = skin_layers(decoded.recipe.skin, context.wavelengths);
  add_to_source(material, "melanin: Jacques 1998; constants: " +
                              std::string(name_of(decoded.recipe.constants)));
  material.skin = std::move(decoded.recipe);
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
