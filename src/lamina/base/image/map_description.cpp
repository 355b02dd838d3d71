// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/map_description.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/io/nearest_name.h"

namespace lamina {
namespace {

constexpr double largest_factor = 1e6;  // beyond, taken for a mistake

}  // namespace

MapDescription decode_map_description(const JsonInput& value, bool may_have_vertex_colors) {
  std::vector<std::string_view> keys = {"map",    "noise", "value", "channel", "encoding", "repeat",
                                        "rotate", "shift", "scale", "offset",  "clamp"};
  if (may_have_vertex_colors) keys.push_back("vertex_colors");
  const JsonObject object = value.object(keys);
  const bool has_file = object.has("map"), has_noise = object.has("noise");
  const auto colors = may_have_vertex_colors ? object.optional("vertex_colors") : std::nullopt;
  const bool has_colors = colors && colors->boolean();
  if (has_file == has_noise && (has_file || !has_colors))
    value.fail(has_file ? "must have \"map\" or \"noise\", but has both"
                        : "must have \"map\" or \"noise\", but has neither");
  MapDescription map{.self = value,
                     .file = object.optional("map"),
                     .noise = object.optional("noise"),
                     .value = object.optional("value"),
                     .channel = object.optional("channel"),
                     .encoding = object.optional("encoding"),
                     .repeat = object.optional("repeat"),
                     .rotate = object.optional("rotate"),
                     .shift = object.optional("shift"),
                     .has_vertex_colors = has_colors};
  if (!has_file)
    for (const auto& given : {map.channel, map.encoding, map.repeat, map.rotate, map.shift})
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

UvPlacement placement_of(const MapDescription& map) {
  constexpr double radians_per_degree = std::numbers::pi / 180.0;
  const NumberRange factor = closed_interval(-1e4, 1e4);
  const std::vector<double> repeat =
      map.repeat ? map.repeat->number_or_numbers(2, factor) : std::vector<double>{1.0, 1.0};
  const double angle =
      map.rotate ? map.rotate->number(closed_interval(-1e6, 1e6, "deg")) * radians_per_degree : 0.0;
  const std::vector<double> shift =
      map.shift ? map.shift->numbers(2, factor) : std::vector<double>{0.0, 0.0};
  const double c = std::cos(angle), s = std::sin(angle);
  const auto vector = [](double x, double y) {
    return Vec2f{static_cast<float>(x), static_cast<float>(y)};
  };
  return {.u_axis = vector(c * repeat[0], s * repeat[0]),
          .v_axis = vector(-s * repeat[1], c * repeat[1]),
          .shift = vector(shift[0], shift[1])};
}

void refuse_placement(const MapDescription& map, std::string_view why) {
  for (const auto& given : {map.repeat, map.rotate, map.shift})
    if (given) given->fail(why);
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
