// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "lamina/layers/materials/material_file.h"
#include "lamina/layers/materials/skin.h"

namespace lamina::material_file {
namespace {

JsonObject skin_object(const JsonInput& recipe) {
  return recipe.object({"melanin", "melanin_blend", "hemoglobin_epidermis", "hemoglobin_dermis",
                        "carotene", "saturation_epidermis", "saturation_dermis", "baseline_scale",
                        "scattering_scale", "scattering_power", "epidermis_thickness",
                        "junction_absorption", "junction_spectrum", "inks", "dermis_thickness",
                        "oiliness", "constants"});
}

constexpr double shortest = 350.0, longest = 1000.0;  // wavelengths of the recipe [nm]
constexpr std::size_t most_points = 1000;

/// The part of a table that the recipe has wavelengths for.
std::vector<std::array<double, 2>> points_of_table(const JsonInput& given) {
  const SpectrumTable table = decode_table(given, closed_interval(0.0, 1.0));
  std::vector<double> wavelengths = {shortest};
  for (const double nm : table.wavelengths)
    if (shortest < nm && nm < longest) wavelengths.push_back(nm);
  wavelengths.push_back(longest);
  std::vector<std::array<double, 2>> points;
  for (const double nm : wavelengths)
    if (table.covers(nm)) points.push_back({nm, interpolate(table, nm)});
  if (points.empty() || points.size() > most_points)
    given.fail("the file must have 1 to 1000 wavelengths in [350, 1000] nm, but has " +
               std::to_string(points.size()));
  return points;
}

/// Pairs of a wavelength and a factor, or the file that holds them.
std::vector<std::array<double, 2>> decode_ink_spectrum(const JsonInput& given) {
  if (given.is_object()) return points_of_table(given);
  std::vector<std::array<double, 2>> points;
  for (const JsonInput& pair : given.array(1, most_points)) {
    const std::vector<JsonInput> both = pair.array(2, 2);
    const double nm = both[0].number(closed_interval(shortest, longest, "nm"));
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
      ink.spectrum = decode_ink_spectrum(*spectrum);
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
    skin.junction_spectrum = decode_ink_spectrum(*spectrum);
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
  require_wavelengths(recipe, context, shortest, longest);
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
