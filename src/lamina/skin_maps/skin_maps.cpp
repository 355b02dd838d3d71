// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin_maps/skin_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "lamina/core/error.h"
#include "lamina/core/number_text.h"
#include "lamina/image/image_file.h"
#include "lamina/image/map_description.h"
#include "lamina/materials/material_file.h"

namespace lamina {
namespace {

constexpr double largest_factor = 1e6;  // beyond, taken for a mistake

/// One channel of an image file, scaled.
Image decode_values(const JsonInput& value) {
  const MapDescription map = decode_map_description(value);
  if (map.noise)
    map.noise->fail(
        "maps of what skin is made of are images: give \"map\", which `lamina maps` makes");
  if (map.repeat) map.repeat->fail("maps of what skin is made of cover the surface once");
  Image image;
  try {
    image = load_image(map.file->file_path(), encoding_of(map, false), map.file->memory());
    require_finite(image, map.file->file_path());
  } catch (const FileError& error) {
    map.file->fail(error.what());
  }
  const std::size_t channel = map.channel ? named_channel(image, *map.channel) : 0;
  const double factor =
      map.value ? map.value->number(closed_interval(-largest_factor, largest_factor)) : 1.0;
  Image values = make_image(image.width, image.height, {"Y"});
  for (std::size_t i = 0; i < values.pixels.size(); ++i) {
    const auto x = static_cast<double>(image.pixels[i * image.channel_count() + channel]);
    values.pixels[i] =
        static_cast<float>(factor * std::clamp(map.offset + map.scale * x, map.low, map.high));
  }
  return values;
}

/// Brings what lies outside the range to its ends; says how much that was.
void clamp(const SkinParameterRange& range, Image& values, std::vector<std::string>& warnings) {
  const auto low = static_cast<float>(range.low), high = static_cast<float>(range.high);
  std::size_t count = 0;
  for (float& value : values.pixels) {
    if (low <= value && value <= high) continue;
    value = std::clamp(value, low, high);
    ++count;
  }
  if (count == 0) return;
  PlainTextStream text;
  text << "skin." << range.name << ": " << count << " of " << values.pixels.size()
       << " texels lie outside [" << range.low << ", " << range.high << "] and were clamped";
  warnings.push_back(text.str());
}

}  // namespace

bool may_be_map(std::string_view parameter) {
  constexpr std::array<std::string_view, 5> same_everywhere = {
      "scattering_scale", "scattering_power", "epidermis_thickness", "dermis_thickness",
      "oiliness"};
  return std::ranges::find(same_everywhere, parameter) == same_everywhere.end();
}

SkinMap decode_skin_map(const SkinParameterRange& range, const JsonInput& value,
                        std::vector<std::string>& warnings) {
  if (!may_be_map(range.name))
    value.fail("must be a number: it is the same everywhere, as scattering, thickness and oil are");
  SkinMap map{range.name, range.value, decode_values(value)};
  clamp(range, map.values, warnings);
  return map;
}

std::pair<int, int> patch_size(const JsonObject& patch, std::span<const SkinMap> maps) {
  constexpr int largest_side = 16384;
  const auto width = patch.optional("width"), height = patch.optional("height");
  const auto side = [](const std::optional<JsonInput>& given) {
    return given ? static_cast<int>(given->integer(1, largest_side)) : 0;
  };
  if (maps.empty() || (width && height))
    return {side(patch.required("width")), side(patch.required("height"))};
  const Image& first = maps.front().values;
  if (!width && !height) return {first.width, first.height};
  const double aspect = static_cast<double>(first.width) / first.height;
  const auto other = [](double length) {
    return std::max(1, static_cast<int>(std::lround(length)));
  };
  if (width) return {side(width), other(side(width) / aspect)};
  return {other(side(height) * aspect), side(height)};
}

SkinMaps decode_skin_maps(const JsonInput& recipe) {
  const JsonObject object = material_file::skin_object(recipe);
  SkinMaps result;
  result.constants = material_file::decode_constants(object);
  result.skin = with_constants({}, result.constants);
  result.skin.junction_spectrum = material_file::decode_junction_spectrum(object);
  for (const SkinParameterRange& range : skin_parameter_ranges()) {
    const auto value = object.optional(range.name);
    if (!value) continue;
    if (!value->is_object()) {
      result.skin.*range.value = value->number(closed_interval(range.low, range.high));
    } else {
      result.maps.push_back(decode_skin_map(range, *value, result.warnings));
    }
  }
  if (const auto oiliness = object.optional("oiliness"))
    result.oiliness = oiliness->number(closed_interval(0.0, 1.0));
  return result;
}

}  // namespace lamina
