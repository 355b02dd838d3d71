// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/seen_surface.h"

#include <algorithm>
#include <cstddef>

namespace lamina {

std::size_t SeenSurface::count() const {
  std::size_t total = 0;
  for (const auto& of_material : points) total += of_material.size();
  return total;
}

float SeenSurface::pixel_size(std::uint32_t material) const {
  std::vector<float> sizes;
  for (const SurfacePoint& point : points[material]) sizes.push_back(point.footprint);
  if (sizes.empty()) return 0.0f;
  const auto low = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 20);
  std::ranges::nth_element(sizes, low);
  return *low;
}

double SeenSurface::area(std::uint32_t material) const {
  const auto pixel = static_cast<double>(pixel_size(material) * pixels_between);
  return 1.5 * static_cast<double>(points[material].size()) * pixel * pixel;
}

}  // namespace lamina
