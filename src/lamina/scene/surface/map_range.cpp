// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/surface/map_range.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lamina/base/spectrum/color.h"

namespace lamina {
namespace {

using Range = std::pair<float, float>;

/// @param value_of  of a texel: red, green, blue
template <class ValueOf>
Range range_of(const Image& image, const ValueOf& value_of) {
  const Image rgb = rgb_image(image);
  Range range{std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest()};
  for (int y = 0; y < rgb.height; ++y)
    for (int x = 0; x < rgb.width; ++x) {
      const float value = value_of(rgb.at(x, y));
      if (!std::isfinite(value)) continue;
      range = {std::min(range.first, value), std::max(range.second, value)};
    }
  return range.first <= range.second ? range : Range{0.0f, 0.0f};
}

/// Of all images of a map.
template <class ValueOf>
Range range_of(const TextureStore& textures, const ImageMap& map, const ValueOf& value_of) {
  Range range = range_of(textures.image(images_of(map).front()), value_of);
  for (const std::size_t image : images_of(map)) {
    const Range other = range_of(textures.image(image), value_of);
    range = {std::min(range.first, other.first), std::max(range.second, other.second)};
  }
  return range;
}

Range range_of(const NoiseMap& noise) {
  return noise.kind == NoiseMap::Kind::smooth ? Range{-3.3f, 3.3f} : Range{0.0f, 1.0f};
}

/// @param value_of  of red, green and blue
template <class ValueOf>
Range range_of(const TextureStore& textures, const TextureMap& map, const ValueOf& value_of) {
  if (const auto* image = std::get_if<ImageMap>(&map.source))
    return range_of(textures, *image, value_of);
  if (const auto* colors = std::get_if<VertexColorMap>(&map.source))
    return {value_of(std::array{colors->low.x, colors->low.y, colors->low.z}.data()),
            value_of(std::array{colors->high.x, colors->high.y, colors->high.z}.data())};
  return range_of(std::get<NoiseMap>(map.source));
}

}  // namespace

std::pair<float, float> range_of(const TextureStore& textures,
                                 std::span<const ScalarParameter> terms) {
  Range total{0.0f, 0.0f};
  for (const ScalarParameter& term : terms) {
    float a = term.value, b = term.value;
    if (const auto& map = term.map) {
      const Range source = range_of(textures, *map, [](const float* texel) {
        return luminance({texel[0], texel[1], texel[2]});
      });
      a *= clamp_to_range(*map, map->offset + map->scale * source.first);
      b *= clamp_to_range(*map, map->offset + map->scale * source.second);
    }
    total.first += std::min(a, b);
    total.second += std::max(a, b);
  }
  return total;
}

std::pair<Vec3f, Vec3f> range_of(const TextureStore& textures, const ColorParameter& color) {
  Vec3f low = color.value, high = color.value;
  if (const auto& map = color.map)
    for (int c = 0; c < 3; ++c) {
      Range source = range_of(textures, *map, [c](const float* texel) { return texel[c]; });
      if (const auto& factor = map->vertex_colors)
        source = {std::min(source.first * factor->low[c], source.first * factor->high[c]),
                  std::max(source.second * factor->low[c], source.second * factor->high[c])};
      const float a = clamp_to_range(*map, map->offset + map->scale * source.first);
      const float b = clamp_to_range(*map, map->offset + map->scale * source.second);
      low[c] *= std::min(a, b);
      high[c] *= std::max(a, b);
    }
  return {low, high};
}

}  // namespace lamina
