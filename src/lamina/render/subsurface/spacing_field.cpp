// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/spacing_field.h"

#include <algorithm>
#include <cmath>

namespace lamina {
namespace {

/// The cube of a width that a place lies in, or the one so many steps further.
std::uint64_t cube_of(const Vec3f& place, float width, int dx = 0, int dy = 0, int dz = 0) {
  constexpr std::int64_t middle = 1 << 20;
  const auto index = [&](float x, int step) {
    const auto at = static_cast<std::int64_t>(std::floor(std::clamp(x / width, -1e6f, 1e6f)));
    return static_cast<std::uint64_t>(at + step + middle);
  };
  return (index(place.x, dx) << 42) | (index(place.y, dy) << 21) | index(place.z, dz);
}

void sort_without_doubles(std::vector<std::uint64_t>& keys) {
  std::ranges::sort(keys);
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}

}  // namespace

SpacingField::SpacingField(std::span<const Vec3f> seen, float spacing, float margin)
    : spacing_(spacing), width_(std::max(8.0f * spacing, margin)) {
  std::vector<Vec3f> places(seen.begin(), seen.end());
  for (std::size_t k = 0; k < near_.size(); ++k) {
    const float wide = width(static_cast<int>(k));
    // One place of each cube is enough.
    std::vector<std::pair<std::uint64_t, Vec3f>> of_cubes;
    for (const Vec3f& place : places) of_cubes.emplace_back(cube_of(place, wide), place);
    std::ranges::sort(of_cubes, {}, &std::pair<std::uint64_t, Vec3f>::first);
    places.clear();
    for (std::size_t i = 0; i < of_cubes.size(); ++i)
      if (i == 0 || of_cubes[i].first != of_cubes[i - 1].first)
        places.push_back(of_cubes[i].second);
    for (const Vec3f& place : places)
      for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dz = -1; dz <= 1; ++dz) near_[k].push_back(cube_of(place, wide, dx, dy, dz));
    sort_without_doubles(near_[k]);
  }
}

int SpacingField::level(const Vec3f& place) const {
  if (is_even()) return 0;
  for (std::size_t k = 0; k < near_.size(); ++k)
    if (std::ranges::binary_search(near_[k], cube_of(place, width(static_cast<int>(k)))))
      return static_cast<int>(k);
  return levels - 1;
}

}  // namespace lamina
