// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/files/skin_features_file.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/resample.h"
#include "lamina/base/io/json_input.h"
#include "lamina/skin/maps/files/skin_maps_file.h"

namespace lamina {
namespace {

constexpr double longest = 1e4;  // [mm]

/// Sets a number of a feature where the object has its key.
void set(const JsonObject& object, std::string_view key, const NumberRange& range, double& value) {
  if (const auto given = object.optional(key)) value = given->number(range);
}

/// A pair of numbers, the lower one first; one number stands for both.
void set(const JsonObject& object, std::string_view key, const NumberRange& range, Span2& span) {
  const auto given = object.optional(key);
  if (!given) return;
  const std::vector<double> ends = given->number_or_numbers(2, range);
  if (ends[0] > ends[1]) given->refuse("must have the lower number first");
  span = {ends[0], ends[1]};
}

void set_place(const JsonObject& object, Span2& place) {
  const std::vector<double> at =
      object.required("at").numbers(2, closed_interval(-longest, longest, "mm"));
  place = {at[0], at[1]};
}

SkinFeature decode_spots(const JsonInput& value, MelaninSpots spots) {
  const JsonObject object =
      value.object({"density", "diameter", "melanin", "melanin_blend", "rim"});
  set(object, "density", closed_interval(0.0, 1000.0, "1/cm2"), spots.density);
  set(object, "diameter", closed_interval(0.05, 100.0, "mm"), spots.diameter);
  set(object, "melanin", closed_interval(0.0, 0.5), spots.melanin);
  set(object, "melanin_blend", closed_interval(0.0, 1.0), spots.melanin_blend);
  set(object, "rim", closed_interval(1e-3, 10.0, "mm"), spots.rim);
  return spots;
}

SkinFeature decode_veins(const JsonInput& value) {
  const JsonObject object = value.object(
      {"count", "levels", "diameter", "depth", "hemoglobin", "saturation", "absorbance"});
  Veins veins = decode_vein_look(object);
  if (const auto count = object.optional("count"))
    veins.count = static_cast<int>(count->integer(0, 1000));
  return veins;
}

SkinFeature decode_blotches(const JsonInput& value) {
  const JsonObject object = value.object({"size", "coverage", "hemoglobin_dermis", "melanin"});
  Blotches blotches;
  set(object, "size", closed_interval(0.1, longest, "mm"), blotches.size);
  set(object, "coverage", closed_interval(0.0, 1.0), blotches.coverage);
  set(object, "hemoglobin_dermis", closed_interval(-0.1, 0.1), blotches.hemoglobin_dermis);
  set(object, "melanin", closed_interval(-0.5, 0.5), blotches.melanin);
  return blotches;
}

/// The ink of an image: dark where it is dark, none where it is transparent.
Image ink_of(const Image& image) {
  const Image rgb = rgb_image(image);
  const auto alpha = channel_index(image, "A");
  Image ink = make_image(image.width, image.height, {"Y"});
  for (std::size_t i = 0; i < ink.pixels.size(); ++i) {
    const float* color = rgb.pixels.data() + 3 * i;
    const float luminance = 0.2126f * color[0] + 0.7152f * color[1] + 0.0722f * color[2];
    const float covered = alpha ? image.pixels[i * image.channel_count() + *alpha] : 1.0f;
    ink.pixels[i] = covered * (1.0f - std::min(1.0f, std::max(0.0f, luminance)));
  }
  return ink;
}

SkinFeature decode_tattoo(const JsonInput& value) {
  const JsonObject object = value.object({"image", "at", "width", "absorbance", "ink"});
  Tattoo tattoo = decode_ink(object);
  set_place(object, tattoo.at);
  return tattoo;
}

SkinFeature decode_pressed(const JsonInput& value) {
  const JsonObject object = value.object({"at", "diameter", "share", "refill", "hyperemia"});
  PressedDisc disc = decode_disc(object);
  set_place(object, disc.at);
  return disc;
}

SkinFeature decode_unevenness(const JsonInput& value) {
  const JsonObject object =
      value.object({"melanin", "melanin_size", "hemoglobin", "hemoglobin_size"});
  Unevenness uneven;
  set(object, "melanin", closed_interval(0.0, 2.0), uneven.melanin);
  set(object, "melanin_size", closed_interval(0.05, longest, "mm"), uneven.melanin_size);
  set(object, "hemoglobin", closed_interval(0.0, 2.0), uneven.hemoglobin);
  set(object, "hemoglobin_size", closed_interval(0.05, longest, "mm"), uneven.hemoglobin_size);
  return uneven;
}

/// The maps of a patch file, brought to its size.
SkinFeature decode_synthesis(const JsonInput& value) {
  const JsonObject object = value.object({"patch", "tile", "use"});
  const JsonInput file = object.required("patch");
  std::vector<SkinMap> maps;
  std::vector<std::string> warnings;
  double mm_per_texel = 0.0;
  try {
    const JsonDocument document = load_json(file.file_path(), file.memory());
    const JsonObject patch =
        document.root().file_object("patch", 1,
                                    {"name", "mm_per_pixel", "width", "height", "bands", "skin",
                                     "light", "totals", "transport"});
    mm_per_texel = patch.required("mm_per_pixel").number(closed_interval(1e-3, 100.0, "mm"));
    const JsonInput skin = patch.required("skin");
    SkinMaps decoded = decode_skin_maps(skin);
    maps = std::move(decoded.maps);
    warnings = std::move(decoded.warnings);
    if (maps.empty()) skin.fail("must have a map to spread, but has numbers only");
    for (const SkinMap& map : maps)
      if (!map.parameter || map.values.channel_count() > 1)
        skin.fail("maps of inks cannot be spread, but \"" + map.name + "\" is one");
    const auto [width, height] = patch_size(patch, &maps.front().values);
    if (std::min(width, height) < MapExample::least_side)
      patch.value().fail("must have at least " + std::to_string(MapExample::least_side) +
                         " texels each way to be spread");
    for (SkinMap& map : maps) {
      const auto [low, high] = std::ranges::minmax(map.values.pixels);
      if (low == high)
        warnings.push_back("map of " + map.name +
                           ": the same everywhere, so spreading it does nothing but set it");
      map.values = resampled(map.values, width, height);
    }
    for (std::string& warning : warnings) warning = file.file_path().string() + ": " + warning;
  } catch (const FileError& error) {
    file.fail(error.what());
  }
  const double side =
      mm_per_texel * std::min(maps.front().values.width, maps.front().values.height);
  double tile = 0.4 * side;
  set(object, "tile", closed_interval(4.0 * mm_per_texel, side, "mm"), tile);
  bool are_factors = false;
  if (const auto use = object.optional("use"))
    are_factors = use->choice<bool>({{"values", false}, {"factors", true}});
  return Synthesis{MapExample(std::move(maps), mm_per_texel, tile), are_factors,
                   std::move(warnings)};
}

SkinFeature decode_feature(const JsonInput& value) {
  (void)value.object(
      {"freckles", "moles", "veins", "blotches", "tattoo", "pressed", "unevenness", "synthesis"});
  const auto entries = value.entries();
  if (entries.size() != 1) value.fail("must have exactly one key, the kind of the feature");
  return decode_skin_feature(entries.front().first, entries.front().second);
}

}  // namespace

void require_ink(const Tattoo& tattoo, SkinParameters skin, const JsonInput& feature) {
  try {
    (void)absorbance_of(tattoo, skin);
  } catch (const InvalidInput& error) {
    feature.fail(error.what());
  }
}

Tattoo decode_ink(const JsonObject& object) {
  Tattoo tattoo;
  const JsonInput file = object.required("image");
  try {
    const Image image = load_image(file.file_path(), ColorEncoding::srgb, file.memory());
    require_finite(image, file.file_path());
    tattoo.image = ink_of(image);
  } catch (const Error& error) {
    file.fail(error.what());
  }
  set(object, "width", closed_interval(0.1, longest, "mm"), tattoo.width);
  set(object, "absorbance", closed_interval(0.0, 10.0), tattoo.absorbance);
  if (const auto ink = object.optional("ink")) tattoo.ink = ink->string();
  return tattoo;
}

PressedDisc decode_disc(const JsonObject& object) {
  PressedDisc disc;
  set(object, "diameter", closed_interval(0.1, longest, "mm"), disc.diameter);
  set(object, "share", closed_interval(0.0, 1.0), disc.share);
  set(object, "refill", closed_interval(0.0, 1.0), disc.refill);
  set(object, "hyperemia", closed_interval(0.0, 5.0), disc.hyperemia);
  return disc;
}

Veins decode_vein_look(const JsonObject& object) {
  Veins veins;
  if (const auto levels = object.optional("levels"))
    veins.levels = static_cast<int>(levels->integer(0, 6));
  set(object, "diameter", closed_interval(0.05, 20.0, "mm"), veins.diameter);
  set(object, "depth", closed_interval(0.0, 10.0, "mm"), veins.depth);
  set(object, "hemoglobin", closed_interval(0.0, 1.0), veins.hemoglobin);
  set(object, "saturation", closed_interval(0.0, 1.0), veins.saturation);
  set(object, "absorbance", closed_interval(0.0, 10.0), veins.absorbance);
  return veins;
}

SkinFeature decode_skin_feature(std::string_view kind, const JsonInput& value) {
  constexpr MelaninSpots mole{.density = 0.5,
                              .diameter = {1.5, 3.5},
                              .melanin = {0.08, 0.2},
                              .melanin_blend = 0.8,
                              .rim = 0.25};
  if (kind == "freckles") return decode_spots(value, {});
  if (kind == "moles") return decode_spots(value, mole);
  if (kind == "veins") return decode_veins(value);
  if (kind == "blotches") return decode_blotches(value);
  if (kind == "tattoo") return decode_tattoo(value);
  if (kind == "pressed") return decode_pressed(value);
  if (kind == "synthesis") return decode_synthesis(value);
  return decode_unevenness(value);
}

SkinMapRecipe load_skin_map_recipe(const JsonFile& file, MemoryBudget memory,
                                   std::span<const std::string> settings) {
  const JsonDocument document = load_json(file, memory, settings);
  const JsonObject object = document.root().file_object(
      "maps", 1, {"width", "height", "mm_per_pixel", "seed", "skin", "features"});
  SkinMapRecipe recipe;
  recipe.width = static_cast<int>(object.required("width").integer(1, 16384));
  recipe.height = static_cast<int>(object.required("height").integer(1, 16384));
  recipe.mm_per_texel = object.required("mm_per_pixel").number(closed_interval(1e-3, 100.0, "mm"));
  if (const auto seed = object.optional("seed"))
    recipe.seed = static_cast<std::uint64_t>(seed->integer(0, std::int64_t{1} << 53));
  const JsonInput skin = object.required("skin");
  recipe.base = decode_skin_maps(skin);
  if (first_map(recipe.base)) skin.fail("must have numbers only: the features make maps of them");
  for (const JsonInput& feature : object.required("features").array()) {
    recipe.features.push_back(decode_feature(feature));
    if (const auto* tattoo = std::get_if<Tattoo>(&recipe.features.back()))
      require_ink(*tattoo, recipe.base.skin, feature);
  }
  return recipe;
}

}  // namespace lamina
