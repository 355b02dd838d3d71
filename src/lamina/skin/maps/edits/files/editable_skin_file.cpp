// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/edits/files/editable_skin_file.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <system_error>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/io/write_places.h"
#include "lamina/skin/fit/skin/number_unit.h"
#include "lamina/skin/maps/files/material_map_file.h"
#include "lamina/skin/patch/files/skin_patch_file.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

fs::path file_of(const fs::path& file_or_folder) {
  std::error_code ignored;
  if (!fs::is_directory(file_or_folder, ignored)) return file_or_folder;
  for (const char* name : {"patch.json", "material.json"})
    if (fs::exists(file_or_folder / name, ignored)) return file_or_folder / name;
  throw FileError(file_or_folder.string() +
                  ": the folder must have a patch.json or a material.json, as lamina maps writes");
}

/// The recipe "skin" of a material with its maps.
SkinMaps skin_of(MappedMaterial material) {
  SkinMaps result;
  result.skin = std::move(material.material.skin->skin);
  result.constants = material.material.skin->constants;
  result.oiliness = material.material.oiliness;
  result.warnings = std::move(material.warnings);
  for (MaterialMap& map : material.maps) {
    const MappableNumber& number = map.number;
    if (number.of == MappableNumber::Of::skin) {
      const SkinParameterRange& range = skin_parameter_ranges()[number.part];
      result.maps.push_back({std::string(range.name), range.value, std::move(map.values)});
    } else if (number.of == MappableNumber::Of::ink) {
      result.maps.push_back({"ink_" + ink_name(result.skin, number.part), nullptr,
                             std::move(map.values), number.part});
    } else if (number.of == MappableNumber::Of::oiliness) {
      result.others.push_back(std::move(map));
    }
  }
  return result;
}

/// Whether a value names a file somewhere, whose place would be another one from a new folder.
bool names_an_image(const JsonInput& value) {
  if (value.is_array()) {
    for (const JsonInput& element : value.array(0, json_max_values))
      if (names_an_image(element)) return true;
    return false;
  }
  if (!value.is_object()) return false;
  for (const auto& [key, part] : value.entries())
    if (key == "map" || key == "file" || names_an_image(part)) return true;
  return false;
}

/// All that the file says but "skin".
JsonOutput rest_of(const JsonInput& root, std::vector<std::string>& warnings) {
  JsonOutput rest = JsonOutput::object();
  for (const auto& [key, value] : root.entries()) {
    if (key == "skin" || key == "$schema") continue;
    if (key == "albedo" || names_an_image(value)) {
      warnings.push_back(value.where() + ": names an image, and is left out of the edited file");
      continue;
    }
    rest[key] = JsonOutput(value);
  }
  return rest;
}

void load_deviations(const fs::path& folder, MemoryBudget& memory, EditableSkin& skin) {
  std::error_code ignored;
  const auto load = [&](const std::string& name, const Image& map) {
    fs::path file = folder / (name + ".sd.exr");
    if (!fs::exists(file, ignored) && name.starts_with("saturation_"))
      file = folder / "saturation.sd.exr";
    if (!fs::exists(file, ignored)) return;
    Image image = load_image(file, ColorEncoding::linear, memory);
    require_finite(image, file);
    for (const float value : image.pixels)
      if (value < 0.0f)
        throw FileError(file.string() + ": standard deviations must be >= 0, but one is " +
                        number_text(value));
    if (image.width != map.width || image.height != map.height ||
        image.channel_count() != map.channel_count())
      throw FileError(file.string() + ": must have the size of the map, " +
                      std::to_string(map.width) + " x " + std::to_string(map.height) +
                      ", but has " + std::to_string(image.width) + " x " +
                      std::to_string(image.height));
    skin.deviations.push_back({name, std::move(image)});
  };
  for (const SkinMap& map : skin.skin.maps) load(map.name, map.values);
  for (const MaterialMap& map : skin.skin.others) load("oiliness", map.values);
}

/// Where there is skin, if the folder says it.
void load_mask(const fs::path& folder, MemoryBudget& memory, EditableSkin& skin) {
  const fs::path file = folder / "mask.exr";
  std::error_code ignored;
  if (!first_map(skin.skin) || !fs::exists(file, ignored)) return;
  Image image = load_image(file, ColorEncoding::linear, memory);
  require_finite(image, file);
  image = select_channels(image, {image.channels.front()});
  image.channels = {"Y"};
  for (const float value : image.pixels)
    if (!(0.0f <= value && value <= 1.0f))
      throw FileError(file.string() + ": must lie in [0, 1], but has " + number_text(value));
  require_alike(file.string() + ":", image, skin.skin);
  skin.mask = std::move(image);
}

/// What a map says of itself: its unit stays that of the number.
std::vector<ImageNote> notes_of(const std::string& file, const std::string& version,
                                const std::string& edited_from) {
  const std::string name = file.substr(0, file.find('.'));
  std::vector<ImageNote> notes = {
      {"lamina.version", version}, {"lamina.number", name}, {"lamina.edited_from", edited_from}};
  const std::string unit =
      unit_of_number(name.starts_with("saturation") ? std::string("saturation") : name);
  if (!unit.empty())
    notes.push_back(
        {"lamina.unit", file.ends_with(".sd.exr") ? "standard deviation of its coordinate" : unit});
  return notes;
}

}  // namespace

EditableSkin load_editable_skin(const fs::path& file_or_folder, MemoryBudget memory) {
  const fs::path file = file_of(file_or_folder);
  EditableSkin result;
  const JsonDocument document = load_json(file, memory);
  const JsonInput root = document.root();
  const auto kind = root.is_object() ? root.peek("lamina") : std::nullopt;
  const bool is_material = kind && kind->is_string() && kind->string() == "material";
  if (is_material) {
    if (!root.peek("skin")) root.fail("must have \"skin\": maps of other recipes are not edited");
    result.skin = skin_of(decode_mapped_material(root));
  } else {
    if (root.is_object() && !root.peek("skin") && root.peek("material"))
      root.fail("must have \"skin\": maps of \"material\" are not edited");
    SkinPatch patch = load_skin_patch(file, memory);
    result.skin = std::move(patch.skin);
    result.width_mm = patch.width * patch.mm_per_texel;
  }
  result.files.push_back(
      {is_material ? "material.json" : "patch.json", rest_of(root, result.skin.warnings)});
  const fs::path other = file.parent_path() / "material.json";
  if (std::error_code ignored;
      file != file_or_folder && !is_material && fs::exists(other, ignored)) {
    const JsonDocument material = load_json(other, memory);
    result.files.push_back({"material.json", rest_of(material.root(), result.skin.warnings)});
  }
  for (MapsFile& each : result.files)
    if (each.name == "material.json") each.rest["length_unit"] = "mm";
  load_deviations(file.parent_path(), memory, result);
  load_mask(file.parent_path(), memory, result);
  return result;
}

void save_editable_skin(const EditableSkin& skin, const fs::path& folder,
                        const std::string& version, const std::string& edited_from) {
  make_folder(folder);
  for (const NamedImage& image : images_of(skin))
    save_exr(*image.image, folder / image.file, ExrPrecision::single_float,
             notes_of(image.file, version, edited_from));
  std::error_code ignored;
  // Those of an edit before, of maps that have none now, would be taken for theirs.
  for (const SkinMap& map : skin.skin.maps)
    if (std::ranges::find(skin.deviations, map.name, &SkinMapDeviation::name) ==
        skin.deviations.end())
      fs::remove(folder / (map.name + ".sd.exr"), ignored);
  // They come last, so that they are there only if the maps are.
  for (const MapsFile& file : skin.files) {
    const std::string text = maps_file_json(skin, file).text(1) + "\n";
    write_file_bytes(folder / file.name,
                     std::span(reinterpret_cast<const std::byte*>(text.data()), text.size()));
  }
}

}  // namespace lamina
