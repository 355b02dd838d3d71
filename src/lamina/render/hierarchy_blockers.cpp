// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "lamina/core/parallel.h"
#include "lamina/render/hierarchy_transport.h"
#include "lamina/render/surface_cells.h"

namespace lamina {

/// Whether a point outside an opaque surface lies within the translucent object: what a ray meets
/// next, but for opaque surfaces, is its boundary from inside.
template <int N>
bool HierarchyTransport<N>::is_inside(const Vec3f& position, const Vec3f& normal) const {
  const std::array<Vec3f, 7> directions = {normal,    Vec3f{1, 0, 0},  Vec3f{-1, 0, 0},
                                           {0, 1, 0}, Vec3f{0, -1, 0}, Vec3f{0, 0, 1},
                                           {0, 0, -1}};
  for (const Vec3f& direction : directions) {
    const Hit hit = scene_.geometry.first_hit({position, direction}, 0.0f);
    if (!hit.is_hit()) return false;
    const SurfacePoint point = make_surface_point(scene_.scene->meshes, hit, 0.0f);
    if (point.material == material_) return dot(point.geometric_normal, direction) > 0.0f;
  }
  return false;
}

template <int N>
std::vector<IrradianceSample<N>> HierarchyTransport<N>::stopped_light(float spacing) const {
  std::vector<IrradianceSample<N>> stopped;
  const auto& materials = scene_.scene->materials;
  const RenderSettings& settings = scene_.scene->render;
  Local local = profiles_.profiles_for(0.0f, {1, 1, 1});
  local.low = local.high = &profiles_.by_thickness().back();
  local.blend = 0.0f;
  local.is_inverted = false;
  local.scale = Bands::filled(1.0f);
  for (std::uint32_t m = 0; m < materials.size(); ++m) {
    const auto* opaque = std::get_if<DiffuseSurface>(&materials[m].surface);
    if (!opaque || materials[m].opacity) continue;
    const auto area = static_cast<float>(surface_area(scene_.scene->meshes, m));
    if (!(area > 0.0f)) continue;
    const float least = std::sqrt(area / static_cast<float>(settings.hierarchy.max_points));
    const SurfaceCells surface =
        make_surface_cells(scene_.scene->meshes, m, std::max(spacing, least), settings.seed);
    std::vector<IrradianceSample<N>> found(surface.cells.size());
    parallel_for(surface.cells.size(), [&](std::size_t i) {
      const SurfaceCell& cell = surface.cells[i];
      const auto elements = surface.elements_of(cell);
      const SurfaceElement& e = elements[elements.size() / 2];
      const SurfacePoint point = make_surface_point(
          scene_.scene->meshes,
          {.distance = 0.0f, .u = e.u, .v = e.v, .mesh = e.mesh, .triangle = e.triangle}, spacing);
      if (!is_inside(leave_surface(point, point.geometric_normal), point.geometric_normal)) return;
      const Bands absorbed =
          Bands::filled(1.0f) - conversion_.from_rgb(scene_.textures.color(opaque->color, point));
      found[i] = {.position = cell.position,
                  .normal = cell.normal,
                  .area = cell.area,
                  .irradiance = absorbed * summed_exitance(cell.position, cell.normal, local),
                  .shade = {}};
    });
    for (const IrradianceSample<N>& sample : found)
      if (largest(sample.irradiance) > 0.0f) stopped.push_back(sample);
  }
  return stopped;
}

#define LAMINA_INSTANTIATE(N)                                                       \
  template bool HierarchyTransport<N>::is_inside(const Vec3f&, const Vec3f&) const; \
  template std::vector<IrradianceSample<N>> HierarchyTransport<N>::stopped_light(float) const
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
