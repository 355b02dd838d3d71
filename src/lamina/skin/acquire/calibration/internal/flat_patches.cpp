// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/internal/flat_patches.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "lamina/skin/acquire/calibration/internal/connected_regions.h"
#include "lamina/skin/acquire/calibration/internal/convex_polygon.h"

namespace lamina {
namespace {

/// The root of each number over that of a bright one, so that dark patches count as eyes see them.
Image as_seen(const Image& rgb) {
  std::vector<float> numbers;
  for (const float v : rgb.pixels)
    if (std::isfinite(v)) numbers.push_back(v);
  Image seen = make_image(rgb.width, rgb.height, rgb.channels);
  if (numbers.empty()) return seen;
  const auto bright =
      numbers.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(numbers.size()));
  std::ranges::nth_element(numbers, bright);
  if (!(*bright > 0.0f)) return seen;
  for (std::size_t i = 0; i < rgb.pixels.size(); ++i) {
    const float v = rgb.pixels[i] / *bright;
    seen.pixels[i] = std::isfinite(v) ? std::sqrt(std::clamp(v, 0.0f, 2.0f)) : 0.0f;
  }
  return seen;
}

/// The largest change from pixel to pixel of any channel, [y][x]; by Sobel's differences.
std::vector<float> largest_gradients(const Image& image) {
  std::vector<float> gradients(image.pixels.size() / 3, 1.0f);  // the rim is no patch
  for (int y = 1; y + 1 < image.height; ++y)
    for (int x = 1; x + 1 < image.width; ++x) {
      float largest = 0.0f;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto at = [&](int i, int j) { return image.at(x + i, y + j)[c]; };
        const float across =
            at(1, -1) + 2.0f * at(1, 0) + at(1, 1) - at(-1, -1) - 2.0f * at(-1, 0) - at(-1, 1);
        const float down =
            at(-1, 1) + 2.0f * at(0, 1) + at(1, 1) - at(-1, -1) - 2.0f * at(0, -1) - at(1, -1);
        largest = std::max(largest, std::hypot(across, down) / 8.0f);
      }
      gradients[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                static_cast<std::size_t>(x)] = largest;
    }
  return gradients;
}

std::optional<FlatPatch> patch_of(const PixelRegion& region, double image_area) {
  const auto pixels = static_cast<double>(region.pixels);
  if (region.touches_edge || region.pixels < 20 || pixels > 0.1 * image_area) return std::nullopt;
  const std::vector<Vec2> hull = convex_hull(region.rim);
  const double area = polygon_area(hull);
  if (pixels < 0.75 * area) return std::nullopt;
  const auto corners = four_corners(hull);
  if (!corners || polygon_area(*corners) < 0.8 * area) return std::nullopt;
  const auto& [a, b, c, d] = *corners;
  double shortest = 1e9, longest = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec2 side = (*corners)[(i + 1) % 4] - (*corners)[i];
    shortest = std::min(shortest, std::hypot(side.x, side.y));
    longest = std::max(longest, std::hypot(side.x, side.y));
  }
  if (longest > 3.0 * shortest) return std::nullopt;
  const double part = turn(a, b, d) / (turn(a, b, d) + turn(c, d, b));  // of a -> c, to b -> d
  return FlatPatch{a + part * (c - a), std::sqrt(area)};
}

}  // namespace

std::vector<FlatPatch> find_flat_patches(const Image& rgb) {
  const std::vector<float> gradients = largest_gradients(as_seen(rgb));
  std::vector<FlatPatch> patches;
  for (const float limit : {0.005f, 0.01f, 0.02f, 0.04f, 0.08f}) {
    std::vector<bool> flat;
    for (const float gradient : gradients) flat.push_back(gradient < limit);
    for (const PixelRegion& region : connected_regions(flat, rgb.width, rgb.height)) {
      const auto patch = patch_of(region, static_cast<double>(gradients.size()));
      if (!patch) continue;
      // The same one, by another limit: the larger is whole.
      const auto known = std::ranges::find_if(patches, [&](const FlatPatch& other) {
        return std::hypot(other.centre.x - patch->centre.x, other.centre.y - patch->centre.y) <
               0.4 * std::max(other.side, patch->side);
      });
      if (known == patches.end())
        patches.push_back(*patch);
      else if (patch->side > known->side)
        *known = *patch;
    }
  }
  return patches;
}

}  // namespace lamina
