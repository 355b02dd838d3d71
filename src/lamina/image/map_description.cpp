// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/image/map_description.h"

#include <string>
#include <vector>

#include "lamina/io/nearest_name.h"

namespace lamina {
namespace {

constexpr double largest_factor = 1e6;  // beyond, taken for a mistake

}  // namespace

MapDescription decode_map_description(const JsonInput& value) {
  const JsonObject object = value.object(
      {"map", "noise", "value", "channel", "encoding", "repeat", "scale", "offset", "clamp"});
  const bool has_file = object.has("map"), has_noise = object.has("noise");
  if (has_file == has_noise)
    value.fail(has_file ? "must have \"map\" or \"noise\", but has both"
                        : "must have \"map\" or \"noise\", but has neither");
  MapDescription map{.self = value,
                     .file = object.optional("map"),
                     .noise = object.optional("noise"),
                     .value = object.optional("value"),
                     .channel = object.optional("channel"),
                     .encoding = object.optional("encoding"),
                     .repeat = object.optional("repeat")};
  if (has_noise)
    for (const auto& given : {map.channel, map.encoding, map.repeat})
      if (given) given->fail("is for a \"map\" only");
  const NumberRange range = closed_interval(-largest_factor, largest_factor);
  if (const auto scale = object.optional("scale")) map.scale = scale->number(range);
  if (const auto offset = object.optional("offset")) map.offset = offset->number(range);
  if (const auto clamp = object.optional("clamp")) {
    const std::vector<double> ends = clamp->numbers(2, range);
    map.low = ends[0];
    map.high = ends[1];
    if (!(map.low <= map.high)) clamp->refuse("must be two numbers, the lower one first");
  }
  return map;
}

Vec2f repeat_of(const MapDescription& map) {
  if (!map.repeat) return {1.0f, 1.0f};
  const auto times = map.repeat->number_or_numbers(2, closed_interval(-1e4, 1e4));
  return {static_cast<float>(times[0]), static_cast<float>(times[1])};
}

ColorEncoding encoding_of(const MapDescription& map, bool is_color) {
  if (is_color && !map.encoding) map.self.fail("\"encoding\" is required, but missing");
  const auto said = map.encoding ? map.encoding->choice<ColorEncoding>() : ColorEncoding::linear;
  if (is_color) return of_colors(said);
  if (stated_encoding(said)) map.encoding->fail("is of colors: of quantities it is linear or srgb");
  return said == ColorEncoding::srgb ? ColorEncoding::srgb_numbers : said;
}

std::size_t named_channel(const Image& image, const JsonInput& channel) {
  const std::string name = channel.string();
  if (const auto found = channel_index(image, name)) return *found;
  std::string list;
  for (const std::string& known : image.channels)
    list += (list.empty() ? "\"" : ", \"") + known + "\"";
  const std::vector<std::string_view> names(image.channels.begin(), image.channels.end());
  channel.fail("the image has no channel \"" + name + "\", but " + list +
               did_you_mean(name, names));
}

}  // namespace lamina
