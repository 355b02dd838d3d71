// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/materials/material_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/layers/materials/builtin_texts.h"

namespace lamina {
namespace {

using material_file::Context;
using material_file::decode_interface;
using material_file::decode_ior;
using material_file::decode_layers;
using material_file::mappable_number;

/// A description by composition instead of `layers`.
struct Recipe {
  std::string_view key;
  void (*decode)(const JsonInput& recipe, const Context& context, Material& material);
};
constexpr std::array<Recipe, 4> recipes = {{{"skin", material_file::decode_skin},
                                            {"leaf", material_file::decode_leaf},
                                            {"paint", material_file::decode_paint},
                                            {"snow", material_file::decode_snow}}};

/// The recipe of a file, if it has one. @throws InvalidInput if there is another description.
const Recipe* find_recipe(const JsonObject& file) {
  const Recipe* found = nullptr;
  for (const Recipe& recipe : recipes) {
    const auto given = file.optional(recipe.key);
    if (!given) continue;
    const std::string other = found != nullptr ? std::string(found->key) : "layers";
    if (file.has(other))
      given->fail("there is \"" + other + "\" already; a material has one of the two");
    found = &recipe;
  }
  return found;
}

BandSet decode_bands(const JsonInput& value) {
  if (value.is_string()) {
    constexpr std::array<std::string_view, 1> names = {"rgb"};
    (void)value.choice(names);
    return BandSet::rgb();
  }
  if (!value.is_array()) value.refuse("must be \"rgb\" or an array of wavelengths [nm]");
  std::vector<double> wavelengths;
  for (const JsonInput& element : value.array(1, 10'000)) {
    wavelengths.push_back(element.number(closed_interval(200.0, 3000.0, "nm")));
    if (wavelengths.size() > 1 && wavelengths.back() <= *(wavelengths.end() - 2))
      element.refuse("must be longer than the wavelength before it");
  }
  return BandSet(std::move(wavelengths));
}

/// The bands of a recipe, which is about spectra.
BandSet decode_recipe_bands(const JsonObject& file, std::string_view recipe) {
  const auto value = file.optional("bands");
  if (!value) return default_spectral_bands();
  BandSet bands = decode_bands(*value);
  if (bands.is_rgb())
    value->fail("\"" + std::string(recipe) +
                "\" computes from spectra: give wavelengths [nm], or nothing for eight from 400 to "
                "645 nm");
  return bands;
}

double mm_per_unit(const JsonInput& unit) {
  return unit.choice<double>({{"mm", 1.0}, {"cm", 10.0}, {"um", 1e-3}, {"m", 1000.0}});
}

/// "ior_below" and "ground", which have a meaning under a finite last layer only.
void decode_below(const JsonObject& file, const Context& context, Material& material) {
  const auto ior = file.optional("ior_below");
  const auto ground = file.optional("ground");
  if (std::isinf(material.layers.back().thickness)) {
    for (const auto& given : {ior, ground})
      if (given) given->fail("must be missing, because the last layer is infinite");
    material.ior_below = material.layers.back().ior;
    return;
  }
  if (!ior) file.value().fail("\"ior_below\" is required, because the last layer is finite");
  material.ior_below = decode_ior(*ior, context);
  if (!ground) return;
  const JsonObject object = ground->object({"reflectance", "roughness", "distribution"});
  material.ground.top = decode_interface(object);
  if (const auto reflectance = object.optional("reflectance"))
    material.ground.reflectance = reflectance->number(closed_interval(0.0, 1.0));
}

}  // namespace

JsonDocument material_with_base(const JsonInput& object) {
  const JsonInput base = *object.peek("base");
  const std::string name = base.string();
  const auto& names = builtin_material_names();
  if (std::ranges::find(names, name) != names.end())
    return laid_over(builtin_material_text(name), name, object);
  const std::filesystem::path file = base.file_path();
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored))
    base.fail("there is no built-in material and no file \"" + name + "\"" +
              did_you_mean(name, names));
  return laid_over(read_stream_bytes(file, base.memory().left), file.string(), object);
}

Material decode_material(const JsonInput& root, const MaterialMaps& maps,
                         std::span<const double> wavelengths) {
  if (root.is_object() && root.peek("base"))
    return decode_material(material_with_base(root).root(), maps, wavelengths);
  const JsonObject file = root.file_object(
      "material", 1,
      {"name", "source", "length_unit", "bands", "ior_above", "ior_below", "surface", "ground",
       "oiliness", "layers", recipes[0].key, recipes[1].key, recipes[2].key, recipes[3].key});
  const Recipe* recipe = find_recipe(file);
  Material material;
  if (const auto name = file.optional("name")) material.name = name->string();
  if (const auto source = file.optional("source")) material.source = source->string();
  material.bands = recipe != nullptr ? decode_recipe_bands(file, recipe->key)
                                     : decode_bands(file.required("bands"));
  if (!wavelengths.empty())
    material.bands = BandSet(std::vector(wavelengths.begin(), wavelengths.end()));
  const JsonInput unit = file.required("length_unit");
  std::vector<std::string> channels;
  for (std::size_t b = 0; b < material.bands.size(); ++b)
    channels.push_back(band_name(material.bands, b) + (material.bands.is_rgb() ? "" : "nm"));
  const auto nm = material.bands.wavelengths();
  const Context context{.bands = material.bands.size(),
                        .has_own_bands = wavelengths.empty(),
                        .length_unit = unit.string(),
                        .mm_per_unit = mm_per_unit(unit),
                        .wavelengths = {nm.begin(), nm.end()},
                        .channels = std::move(channels),
                        .maps = maps};
  material.ior_above.assign(context.bands, 1.0);
  if (const auto ior = file.optional("ior_above")) material.ior_above = decode_ior(*ior, context);
  if (recipe != nullptr)
    recipe->decode(*file.optional(recipe->key), context, material);
  else
    material.layers = decode_layers(file.required("layers"), context);
  if (const auto oiliness = file.optional("oiliness")) {
    if (recipe != nullptr && recipe->key == "skin")
      oiliness->fail("stands in \"skin\" where that is given");
    material.oiliness = mappable_number(
        *oiliness,
        {.of = MappableNumber::Of::oiliness, .name = "oiliness", .low = 0.0, .high = 1.0}, context);
  }
  if (const auto surface = file.optional("surface")) {
    const JsonObject object = surface->object({"roughness", "distribution", "specular_roughness"});
    (void)object.required("roughness");
    material.layers.front().top = decode_interface(object, &context);
    if (const auto roughness = object.optional("specular_roughness"))
      material.specular_roughness =
          material_file::plain_number(*roughness, closed_interval(0.0, 1.0));
  } else if (material.skin) {
    material.specular_roughness = skin_specular_roughness;
  }
  decode_below(file, context, material);
  return material;
}

Material load_material(const std::filesystem::path& file) {
  MemoryBudget memory;
  return load_material(file, memory);
}

Material load_material(const std::filesystem::path& file, MemoryBudget& memory,
                       const MaterialMaps& maps) {
  const JsonDocument document = load_json(file, memory);
  return decode_material(document.root(), maps);
}

Material parse_material(const std::string& text, const std::string& name) {
  const JsonDocument document = parse_json(text, name);
  return decode_material(document.root());
}

}  // namespace lamina
