// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/files/acquired_files.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_output.h"
#include "lamina/base/io/write_places.h"
#include "lamina/layers/materials/skin.h"
#include "lamina/skin/fit/skin/number_unit.h"
#include "lamina/skin/maps/mapped_skin_json.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

std::string coordinate_of(const FitParameter& parameter) {
  switch (parameter.scale) {
    case FitScale::logarithmic:
      return parameter.offset > 0.0 ? "ln(value + " + number_text(parameter.offset) + ")"
                                    : "ln(value)";
    case FitScale::logit:
      return "logit of the value in [" + number_text(parameter.low) + ", " +
             number_text(parameter.high) + "]";
    case FitScale::linear:
      break;
  }
  return "value";
}

std::vector<ImageNote> notes_of(const AcquiredNumber& number, const Capture& capture,
                                const std::string& version) {
  const std::string& name = number.number.parameter.name;
  return {{"lamina.version", version},
          {"lamina.number", name},
          {"lamina.unit", unit_of_number(name)},
          {"lamina.capture", capture.name},
          {"lamina.population", capture.population_name},
          {"lamina.prior_share", number_text(number.prior_share)},
          {"lamina.told", number.prior_share <= share_of_prior    ? "by the capture"
                          : number.within_share <= share_of_prior ? "differences only"
                                                                  : "from the prior"}};
}

/// The maps by the names that recipes of skin have, without their pixels.
SkinMaps recipe_of(const AcquiredSkin& skin, const Capture& capture) {
  SkinMaps recipe{.skin = capture.skin.skin, .constants = capture.skin.constants};
  for (const AcquiredNumber& number : skin.numbers)
    for (double SkinParameters::*const value : number.number.values)
      for (const SkinParameterRange& range : skin_parameter_ranges())
        if (range.value == value) recipe.maps.push_back({std::string(range.name), value, {}});
  return recipe;
}

/// The recipe with the file of each number; one map may give several.
JsonOutput skin_json(const AcquiredSkin& skin, const Capture& capture) {
  const SkinMaps recipe = recipe_of(skin, capture);
  JsonOutput json = mapped_skin_json(recipe, recipe.maps);
  for (const AcquiredNumber& number : skin.numbers)
    for (const SkinMap& map : recipe.maps)
      if (std::ranges::count(number.number.values, map.parameter) > 0)
        json[map.name] = {{"map", number.number.parameter.name + ".exr"}};
  return json;
}

}  // namespace

namespace {

/// The piece of skin as a rectangle on a table, in mm, with a lamp to its left.
JsonOutput scene_json(const AcquiredSkin& skin, double mm_per_pixel) {
  const double width = skin.width * mm_per_pixel, height = skin.height * mm_per_pixel;
  const double size = std::max(width, height);
  const auto place = [&](double x, double y, double z) {
    return JsonOutput::array({x * size, y * size, z * size});
  };
  JsonOutput camera = {{"position", place(0.15, -1.15, 1.35)},
                       {"up", JsonOutput::array({0, 0, 1})},
                       {"look_at", place(0.0, 0.0, 0.0)},
                       {"horizontal_fov", 40}};
  return {
      {"lamina", "scene"},
      {"version", 1},
      {"mm_per_unit", 1},
      {"camera", camera},
      {"film", {{"width", 512}, {"height", 512}}},
      {"materials", {{"skin", {{"subsurface", "material.json"}}}}},
      {"meshes",
       JsonOutput::array(
           {{{"shape", "rectangle"}, {"width", width}, {"height", height}, {"material", "skin"}}})},
      {"lights", JsonOutput::array({{{"type", "rectangle"},
                                     {"position", place(-1.5, -0.2, 1.1)},
                                     {"look_at", place(0.0, 0.0, 0.0)},
                                     {"size", JsonOutput::array({0.6 * size, 0.6 * size})},
                                     {"radiance", 18}},
                                    {{"type", "environment"}, {"radiance", 0.25}}})},
      {"render", {{"method", "texture_space"}, {"samples_per_pixel", 16}}}};
}

}  // namespace

AcquiredFiles save_acquired(const AcquiredSkin& skin, const Capture& capture,
                            const fs::path& folder, const std::string& version) {
  make_folder(folder);
  AcquiredFiles files;
  for (const AcquiredNumber& number : skin.numbers) {
    const std::string& name = number.number.parameter.name;
    std::vector<ImageNote> notes = notes_of(number, capture, version);
    files.maps.push_back(folder / (name + ".exr"));
    save_exr(number.values, files.maps.back(), ExrPrecision::single_float, notes);
    notes[2] = {"lamina.unit", "standard deviation of " + coordinate_of(number.number.parameter)};
    files.deviations.push_back(folder / (name + ".sd.exr"));
    save_exr(number.deviations, files.deviations.back(), ExrPrecision::half, notes);
  }
  Image mask = make_image(skin.width, skin.height, {"Y"});
  for (std::size_t i = 0; i < skin.kinds.size(); ++i)
    mask.pixels[i] = skin.kinds[i] == PixelKind::skin ? 1.0f : 0.0f;
  files.mask = folder / "mask.exr";
  save_exr(mask, files.mask);
  const JsonOutput recipe = skin_json(skin, capture);
  const auto write = [](const fs::path& file, const JsonOutput& json) {
    const std::string text = json.text(1) + "\n";
    write_file_bytes(file, std::as_bytes(std::span(text)));
  };
  files.material = folder / "material.json";
  write(files.material,
        {{"lamina", "material"},
         {"version", 1},
         {"name", capture.name},
         {"length_unit", "mm"},
         {"surface", {{"roughness", 0}, {"specular_roughness", skin_specular_roughness}}},
         {"skin", recipe}});
  if (capture.mm_per_pixel) {
    files.patch = folder / "patch.json";
    write(files.patch, {{"lamina", "patch"},
                        {"version", 1},
                        {"mm_per_pixel", *capture.mm_per_pixel},
                        {"width", skin.width},
                        {"height", skin.height},
                        {"skin", recipe}});
    files.scene = folder / "scene.json";
    write(files.scene, scene_json(skin, *capture.mm_per_pixel));
  }
  return files;
}

}  // namespace lamina
