// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/write_places.h"
#include "lamina/scene/skin_surface/surface_skin_maps.h"
#include "lamina/skin/maps/files/skin_features_file.h"
#include "lamina/skin/maps/mapped_skin_json.h"
#include "lamina/skin/maps/skin_features.h"
#include "picture_files.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

struct MapsOptions {
  CommonOptions common;
  std::string recipe, output;
  std::vector<std::string> settings;
  bool has_pictures = false;
  Option seed;
};

/// A map to look at: its lowest value black, its highest white.
Image picture_of(Image map) {
  const auto [low, high] = std::ranges::minmax(map.pixels);
  for (float& value : map.pixels) value = high > low ? (value - low) / (high - low) : 0.0f;
  return map;
}

/// A patch file that uses the maps.
JsonOutput patch_json(const SkinMapRecipe& recipe, const std::vector<SkinMap>& maps) {
  return {{"lamina", "patch"},
          {"version", 1},
          {"mm_per_pixel", recipe.mm_per_texel},
          {"width", recipe.width},
          {"height", recipe.height},
          {"skin", mapped_skin_json(recipe.base, maps)}};
}

/// A material file that uses the maps of a surface.
JsonOutput material_json(const SurfaceMapRecipe& recipe, const std::vector<SkinMap>& maps) {
  return {{"lamina", "material"},
          {"version", 1},
          {"length_unit", "mm"},
          {"skin", mapped_skin_json(recipe.base, maps)}};
}

/// Says what is to be known of the patches that a recipe spreads.
template <class Features, class KindOf>
void warn_of_patches(const Features& features, const KindOf& kind_of, JsonOutput& json) {
  for (const auto& feature : features)
    if (const auto* synthesis = std::get_if<Synthesis>(&kind_of(feature)))
      for (const std::string& warning : synthesis->warnings) {
        say("warning: " + warning);
        json["warnings"].push_back(warning);
      }
}

void run_maps(const MapsOptions& options) {
  for (const char* ending : {".exr", ".png", ".json"})
    if (lower_case_ending(options.output) == ending)
      throw InvalidInput("--output: must be a folder, not a file, but is " + options.output);
  const fs::path folder =
      options.output.empty() ? named_after(options.recipe, "folder") : options.output;
  require_writable_folder(folder);
  const bool has_seed = options.seed.is_given();
  const Progress progress = make_progress("making maps", Keeps::nothing);
  std::vector<SkinMap> maps;
  JsonOutput json = make_result("maps");
  json["warnings"] = JsonOutput::array();
  std::string text;
  std::string user;  // of the maps: a file to render
  JsonOutput user_json;
  if (auto on_mesh =
          load_surface_map_recipe(options.recipe, options.common.memory, options.settings)) {
    if (has_seed) on_mesh->seed = options.common.seed;
    const auto kind_of = [](const SurfaceFeature& feature) -> auto& { return feature.kind; };
    warn_of_patches(on_mesh->features, kind_of, json);
    std::vector<ColorMatch> matches;
    maps = make_surface_maps(*on_mesh, progress, &matches);
    for (const ColorMatch& match : matches) {
      text += fmt::format(
          "colors are most like skin at an exposure of {:.3f}: half are within {:.1f} standard "
          "deviations of people's\n",
          match.exposure, match.distance);
      json["exposure"] = match.exposure;
    }
    user = "material";
    user_json = material_json(*on_mesh, maps);
  } else {
    SkinMapRecipe recipe =
        load_skin_map_recipe(options.recipe, options.common.memory, options.settings);
    if (has_seed) recipe.seed = options.common.seed;
    warn_of_patches(recipe.features, std::identity{}, json);
    maps = make_skin_maps(recipe, progress);
    user = "patch";
    user_json = patch_json(recipe, maps);
  }
  make_folder(folder);
  json["maps"] = JsonOutput::array();
  for (const SkinMap& map : maps) {
    const fs::path file = folder / (map.name + ".exr");
    save_exr(map.values, file, ExrPrecision::single_float);
    if (options.has_pictures) save_png(picture_of(map.values), folder / (map.name + ".png"));
    const auto [low, high] = std::ranges::minmax(map.values.pixels);
    text += fmt::format("{}: {:.4g} to {:.4g}\n", file.string(), low, high);
    json["maps"].push_back(
        {{"file", file.string()}, {"parameter", map.name}, {"lowest", low}, {"highest", high}});
  }
  const fs::path user_file = folder / (user + ".json");
  write_file(user_file.string(), user_json.text(1) + "\n");
  text += user_file.string() + "\n";
  json[user] = user_file.string();
  write_json(json, options.common);
  print(options.common, text);
}

}  // namespace

void add_maps_command(CLI::App& app) {
  auto options = std::make_shared<MapsOptions>();
  const Command command(
      app, "maps",
      "Makes maps of what skin is made of: freckles, moles, veins, blotches, tattoos, or a "
      "captured "
      "patch spread over more skin; on a flat patch or over the texture coordinates of a mesh.");
  command.add_option("recipe", options->recipe, "maps file").type_name("MAPS").required();
  add_settings_option(command, options->settings, "maps file");
  command
      .add_option(
          "-o,--output", options->output,
          "folder for an EXR per parameter, and patch.json that uses them; of a recipe on a mesh "
          "material.json")
      .type_name("FOLDER");
  command.add_flag("--png", options->has_pictures,
                   "also a PNG of each map to look at: its lowest value black, its highest white");
  add_common_options(command, options->common);
  options->seed = command.option("--seed");
  command.footer(
      "docs/heterogeneous_skin.md has the file format; a maps file may be as short as\n"
      "  { \"lamina\": \"maps\", \"version\": 1, \"width\": 400, \"height\": 400, "
      "\"mm_per_pixel\": 0.05,\n"
      "    \"skin\": { \"melanin\": 0.01 }, \"features\": [ { \"freckles\": { \"density\": 9 } } ] "
      "}\n"
      "Example: lamina maps examples/skin/freckles.json -o freckles && lamina patch "
      "freckles/patch.json");
  command.callback([options] { run_maps(*options); });
}

}  // namespace lamina::cli
