// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/color_space.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "lamina/base/image/cryptomatte.h"

namespace lamina {
namespace {

/// Where R, G and B stand in a pixel, of each layer that has them.
std::vector<std::array<std::size_t, 3>> colors_of(const Image& image) {
  std::vector<std::array<std::size_t, 3>> colors;
  for (std::size_t red = 0; red < image.channels.size(); ++red) {
    const std::string& name = image.channels[red];
    if ((name != "R" && !name.ends_with(".R")) || is_cryptomatte(name)) continue;
    const std::string layer = name.substr(0, name.size() - 1);
    const std::optional<std::size_t> green = channel_index(image, layer + "G");
    const std::optional<std::size_t> blue = channel_index(image, layer + "B");
    if (green && blue) colors.push_back({red, *green, *blue});
  }
  return colors;
}

}  // namespace

Image converted_colors(Image image, const Matrix3& conversion, Negative negative) {
  const auto colors = colors_of(image);
  if (colors.empty()) return image;
  for (std::size_t at = 0; at < image.pixels.size(); at += image.channel_count())
    for (const auto& places : colors) {
      std::array<double, 3> color{};
      for (std::size_t c = 0; c < 3; ++c)
        color[c] = static_cast<double>(image.pixels[at + places[c]]);
      const bool keeps = negative == Negative::kept ||
                         std::ranges::any_of(color, [](double value) { return value < 0.0; });
      color = conversion * color;
      for (std::size_t c = 0; c < 3; ++c)
        image.pixels[at + places[c]] =
            static_cast<float>(keeps || !(color[c] < 0.0) ? color[c] : 0.0);
    }
  return image;
}

Image decoded_colors(Image image, const RgbCurve& curve) {
  if (is_linear(curve)) return image;
  std::vector<std::size_t> places;
  for (const auto& color : colors_of(image))
    places.insert(places.end(), color.begin(), color.end());
  if (const auto grey = channel_index(image, "Y")) places.push_back(*grey);
  for (std::size_t at = 0; at < image.pixels.size(); at += image.channel_count())
    for (const std::size_t place : places) {
      float& number = image.pixels[at + place];
      number = static_cast<float>(linear_light(curve, static_cast<double>(number)));
    }
  return image;
}

bool has_colors(const Image& image) { return !colors_of(image).empty(); }

}  // namespace lamina
