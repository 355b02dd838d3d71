// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/plot/map_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lamina/base/spectrum/srgb.h"

namespace lamina {
namespace {

/// Nine of the colors of viridis, evenly spaced, 8 bit sRGB.
constexpr std::array<std::array<int, 3>, 9> stops = {{{68, 1, 84},
                                                      {71, 44, 122},
                                                      {59, 81, 139},
                                                      {44, 113, 142},
                                                      {33, 144, 141},
                                                      {39, 173, 129},
                                                      {92, 200, 99},
                                                      {170, 220, 50},
                                                      {253, 231, 37}}};

}  // namespace

Image map_picture(const Image& map, double low, double high,
                  const std::function<bool(std::size_t)>& is_shown) {
  Image picture = make_image(map.width, map.height, {"R", "G", "B", "A"});
  const std::size_t count = picture.pixels.size() / 4;
  for (std::size_t i = 0; i < count; ++i) {
    if (is_shown && !is_shown(i)) continue;
    const double value = static_cast<double>(map.pixels[i * map.channel_count()]);
    const double x = std::clamp((value - low) / (high - low), 0.0, 1.0) * (stops.size() - 1);
    const auto stop = std::min(static_cast<std::size_t>(x), stops.size() - 2);
    for (std::size_t c = 0; c < 3; ++c)
      picture.pixels[4 * i + c] = static_cast<float>(srgb_decode(
          std::lerp(static_cast<double>(stops[stop][c]), static_cast<double>(stops[stop + 1][c]),
                    x - static_cast<double>(stop)) /
          255.0));
    picture.pixels[4 * i + 3] = 1.0f;
  }
  return picture;
}

std::string map_gradient() {
  std::string css = "linear-gradient(to right";
  for (const auto& stop : stops)
    css += ", rgb(" + std::to_string(stop[0]) + " " + std::to_string(stop[1]) + " " +
           std::to_string(stop[2]) + ")";
  return css + ")";
}

}  // namespace lamina
