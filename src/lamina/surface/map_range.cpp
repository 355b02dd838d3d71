// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/surface/map_range.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lamina/spectrum/color.h"
#include "lamina/surface/texture.h"

namespace lamina {
namespace {

using Range = std::pair<float, float>;

Range range_of(const Image& image) {
  const Image rgb = rgb_image(image);
  Range range{std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest()};
  for (int y = 0; y < rgb.height; ++y)
    for (int x = 0; x < rgb.width; ++x) {
      const float* texel = rgb.at(x, y);
      const float value = luminance({texel[0], texel[1], texel[2]});
      if (!std::isfinite(value)) continue;
      range = {std::min(range.first, value), std::max(range.second, value)};
    }
  return range.first <= range.second ? range : Range{0.0f, 0.0f};
}

Range range_of(const NoiseMap& noise) {
  return noise.kind == NoiseMap::Kind::smooth ? Range{-3.3f, 3.3f} : Range{0.0f, 1.0f};
}

}  // namespace

std::pair<float, float> range_of(const std::vector<Image>& images,
                                 std::span<const ScalarParameter> terms) {
  Range total{0.0f, 0.0f};
  for (const ScalarParameter& term : terms) {
    float a = term.value, b = term.value;
    if (const auto& map = term.map) {
      const auto* image = std::get_if<ImageMap>(&map->source);
      const Range source =
          image ? range_of(images[image->image]) : range_of(std::get<NoiseMap>(map->source));
      a *= clamp_to_range(*map, map->offset + map->scale * source.first);
      b *= clamp_to_range(*map, map->offset + map->scale * source.second);
    }
    total.first += std::min(a, b);
    total.second += std::max(a, b);
  }
  return total;
}

}  // namespace lamina
