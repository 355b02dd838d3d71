// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/surface_points.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "lamina/render/subsurface/surface_cells.h"

namespace lamina {

std::vector<SurfacePoint> some_of(const std::vector<SurfacePoint>& all, std::size_t most) {
  std::vector<std::uint32_t> order(all.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](std::uint32_t i) {
    const Vec3f& p = all[i].position;
    return std::tuple(p.x, p.y, p.z);
  });
  const std::size_t count = std::min(most, all.size());
  std::vector<SurfacePoint> some;
  some.reserve(count);
  for (std::size_t i = 0; i < count; ++i) some.push_back(all[order[i * all.size() / count]]);
  return some;
}

std::vector<SurfacePoint> points_all_over(const Scene& scene, std::uint32_t material,
                                          std::size_t count) {
  const double area = surface_area(scene.meshes, material);
  if (!(area > 0.0)) return {};
  const auto spacing = static_cast<float>(std::sqrt(area / static_cast<double>(count)));
  const SurfaceCells surface =
      make_surface_cells(scene.meshes, material, spacing, scene.render.seed);
  std::vector<SurfacePoint> points;
  for (const SurfaceCell& cell : surface.cells) {
    const SurfaceElement& e = surface.elements_of(cell).front();
    const Hit hit{.distance = 0.0f, .u = e.u, .v = e.v, .mesh = e.mesh, .triangle = e.triangle};
    points.push_back(make_surface_point(scene.meshes, hit, spacing));
  }
  return points;
}

}  // namespace lamina
