// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/image.h"

#include <algorithm>

#include "lamina/base/core/error.h"

namespace lamina {

std::optional<std::size_t> channel_index(const Image& image, std::string_view name) {
  const auto found = std::ranges::find(image.channels, name);
  if (found == image.channels.end()) return std::nullopt;
  return static_cast<std::size_t>(found - image.channels.begin());
}

Image select_channels(const Image& image, const std::vector<std::string>& names) {
  std::vector<std::size_t> sources;
  for (const std::string& name : names) {
    const std::optional<std::size_t> index = channel_index(image, name);
    if (!index) throw InvalidInput("image: channel " + name + " is required, but missing");
    sources.push_back(*index);
  }
  Image selected = make_image(image.width, image.height, names);
  float* to = selected.pixels.data();
  for (std::size_t from = 0; from < image.pixels.size(); from += image.channel_count())
    for (const std::size_t source : sources) *to++ = image.pixels[from + source];
  return selected;
}

Image unpremultiplied(Image image) {
  const auto alpha = channel_index(image, "A");
  if (!alpha) return image;
  for (const char* const name : {"R", "G", "B", "Y"})
    if (const auto channel = channel_index(image, name))
      for (std::size_t at = 0; at < image.pixels.size(); at += image.channel_count())
        if (const float a = image.pixels[at + *alpha]; a > 0.0f) image.pixels[at + *channel] /= a;
  return image;
}

Image rgb_image(const Image& image) {
  if (channel_index(image, "R") && channel_index(image, "G") && channel_index(image, "B"))
    return select_channels(image, {"R", "G", "B"});
  const bool has_y = channel_index(image, "Y").has_value();
  if (!has_y && image.channel_count() != 1)
    throw InvalidInput("image: channels R, G, B, or Y are required");
  const std::string grey = has_y ? "Y" : image.channels[0];
  Image rgb = select_channels(image, {grey, grey, grey});
  rgb.channels = {"R", "G", "B"};
  return rgb;
}

}  // namespace lamina
