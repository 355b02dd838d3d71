// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/files/material_map_file.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "lamina/base/core/error.h"
#include "lamina/base/core/float_within.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/map_description.h"
#include "lamina/base/io/kept_readings.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/layers/materials/material_file.h"

namespace lamina {
namespace {

constexpr double largest_factor = 1e6;  // beyond, taken for a mistake

/// The channels of an image that a map takes: those of all bands, or one.
std::vector<std::size_t> channels_of(const MapDescription& map, const MappableNumber& number,
                                     const Image& image) {
  if (map.channel) return {named_channel(image, *map.channel)};
  std::vector<std::size_t> channels;
  for (const std::string& name : number.channels)
    if (const auto channel = channel_index(image, name)) channels.push_back(*channel);
  if (channels.empty() || channels.size() < number.channels.size()) return {0};
  return channels;
}

/// The image of a file, scaled, its lengths in mm.
Image decode_values(const MappableNumber& number, const JsonInput& value) {
  const MapDescription map = decode_map_description(value);
  if (map.noise)
    map.noise->fail(
        "maps of what materials are made of are images: give \"map\", which `lamina maps` makes");
  refuse_placement(map, "maps of what materials are made of cover the surface once");
  Image image;
  try {
    image = load_image(map.file->file_path(), encoding_of(map, false), map.file->memory());
    require_finite(image, map.file->file_path());
  } catch (const FileError& error) {
    map.file->fail(error.what());
  }
  const std::vector<std::size_t> channels = channels_of(map, number, image);
  const double factor =
      number.unit *
      (map.value ? map.value->number(closed_interval(-largest_factor, largest_factor)) : 1.0);
  Image values = make_image(image.width, image.height,
                            channels.size() > 1 ? number.channels : std::vector<std::string>{"Y"});
  for (std::size_t i = 0; i < values.pixels.size(); ++i) {
    const std::size_t texel = i / channels.size(), channel = channels[i % channels.size()];
    const auto x = static_cast<double>(image.pixels[texel * image.channel_count() + channel]);
    values.pixels[i] =
        static_cast<float>(factor * std::clamp(map.offset + map.scale * x, map.low, map.high));
  }
  return values;
}

/// Brings what lies outside the range to its ends; says how much that was.
void clamp(const MappableNumber& number, Image& values, std::vector<std::string>& warnings) {
  const auto low = static_cast<float>(number.low), high = static_cast<float>(number.high);
  std::size_t count = 0;
  for (float& value : values.pixels) {
    if (!(low <= value && value <= high)) ++count;
    value = float_within(static_cast<double>(value), number.low, number.high);
  }
  if (count == 0) return;
  PlainTextStream text;
  text << number.name << ": " << count << " of " << values.pixels.size() << " texels lie outside ["
       << number.low << ", " << number.high << "] and were clamped";
  warnings.push_back(text.str());
}

}  // namespace

MaterialMap decode_material_map(const MappableNumber& number, const JsonInput& value,
                                std::vector<std::string>& warnings) {
  MaterialMap map{number, decode_values(number, value)};
  clamp(number, map.values, warnings);
  return map;
}

MappedMaterial decode_mapped_material(const JsonInput& value) {
  MappedMaterial result;
  const MaterialMaps take = [&](const MappableNumber& number, const JsonInput& map) {
    result.maps.push_back(decode_material_map(number, map, result.warnings));
    return means_of(result.maps.back());
  };
  if (value.is_object()) {
    result.material = decode_material(value, take);
    return result;
  }
  const std::string name = value.string();
  std::vector<std::string_view> names;
  for (const Material& material : builtin_materials()) names.push_back(material.name);
  std::error_code ignored;
  if (std::ranges::find(names, name) != names.end())
    result.material = find_material(name);
  else if (std::filesystem::exists(value.file_path(), ignored))
    result = kept_reading<MappedMaterial>("material " + value.file_path().string(), [&] {
      result.material = load_material(value.file_path(), value.memory(), take);
      return std::move(result);
    });
  else
    value.fail("there is no built-in material and no file \"" + name + "\"" +
               did_you_mean(name, names));
  return result;
}

}  // namespace lamina
