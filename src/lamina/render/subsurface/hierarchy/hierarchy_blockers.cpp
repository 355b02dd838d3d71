// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lamina/base/core/parallel.h"
#include "lamina/render/subsurface/hierarchy/hierarchy_transport.h"
#include "lamina/render/subsurface/surface_cells.h"

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
std::vector<typename InnerBlockers<N>::Patch> HierarchyTransport<N>::patches_inside(
    const std::vector<Mesh>& mesh, std::uint32_t material, float spacing) const {
  const auto& color = std::get<DiffuseSurface>(scene_.scene->materials[material].surface).color;
  const SurfaceCells surface = make_surface_cells(mesh, material, spacing, scene_.settings.seed);
  std::vector<typename InnerBlockers<N>::Patch> found(surface.cells.size());
  parallel_for(surface.cells.size(), [&](std::size_t i) {
    const SurfaceCell& cell = surface.cells[i];
    const auto elements = surface.elements_of(cell);
    const SurfaceElement& e = elements[elements.size() / 2];
    const SurfacePoint point = make_surface_point(
        mesh, {.distance = 0.0f, .u = e.u, .v = e.v, .mesh = e.mesh, .triangle = e.triangle},
        spacing);
    if (!is_inside(leave_surface(point, point.geometric_normal), point.geometric_normal)) return;
    found[i] = {.position = cell.position,
                .normal = cell.normal,
                .area = cell.area,
                .reflectance = conversion_.from_rgb(scene_.textures.color(color, point))};
  });
  std::erase_if(found, [](const auto& patch) { return !(patch.area > 0.0f); });
  return found;
}

template <int N>
std::vector<typename HierarchyTransport<N>::Inside> HierarchyTransport<N>::objects_inside() const {
  std::vector<Inside> inside;
  const auto& materials = scene_.scene->materials;
  for (std::uint32_t m = 0; m < materials.size(); ++m) {
    if (!std::holds_alternative<DiffuseSurface>(materials[m].surface) || materials[m].opacity)
      continue;
    for (const Mesh& mesh : scene_.scene->meshes) {
      if (std::ranges::find(mesh.material, m) == mesh.material.end()) continue;
      const std::vector<Mesh> alone = {mesh};
      constexpr double few = 200.0;
      const double area = surface_area(alone, m);
      if (!(area > 0.0)) continue;
      double found = 0.0;
      for (const auto& patch : patches_inside(alone, m, static_cast<float>(std::sqrt(area / few))))
        found += static_cast<double>(patch.area);
      if (found > 0.0) inside.push_back({alone, m, found, found / area});
    }
  }
  return inside;
}

template <int N>
typename HierarchyTransport<N>::BlockerPatches HierarchyTransport<N>::blocker_patches(
    float spacing, float mfp) const {
  const std::vector<Inside> inside = objects_inside();
  BlockerPatches patches;
  if (inside.empty()) return patches;
  double area_inside = 0.0;
  for (const Inside& object : inside) area_inside += object.area;
  const auto& meshes = scene_.scene->meshes;
  constexpr double most = 0.85 * static_cast<double>(InnerBlockers<N>::most_patches);
  const double area = area_inside + surface_area(meshes, material_);
  constexpr double widest = 1.5;  // mean free paths
  const auto with_surface = static_cast<float>(std::sqrt(area / most));
  const bool has_surface = with_surface < widest * mfp;
  for (float wide = has_surface
                        ? std::max(with_surface, 0.5f * mfp)
                        : std::max(spacing, static_cast<float>(std::sqrt(area_inside / most)));
       ; wide *= 1.2f) {
    patches = {};
    for (const auto& [mesh, material, object_area, fraction] : inside)
      for (auto patch : patches_inside(mesh, material, wide)) {
        patch.radius = static_cast<float>(std::sqrt(object_area / (4.0 * std::numbers::pi)));
        patches.inner.push_back(patch);
      }
    if (has_surface)
      for (const SurfaceCell& cell :
           make_surface_cells(meshes, material_, wide, scene_.settings.seed).cells)
        patches.outer.push_back({cell.position, cell.normal, cell.area, {}});
    if (patches.inner.size() + patches.outer.size() <= InnerBlockers<N>::most_patches)
      return patches;
  }
}

#define LAMINA_INSTANTIATE(N)                                                                 \
  template bool HierarchyTransport<N>::is_inside(const Vec3f&, const Vec3f&) const;           \
  template std::vector<InnerBlockers<N>::Patch> HierarchyTransport<N>::patches_inside(        \
      const std::vector<Mesh>&, std::uint32_t, float) const;                                  \
  template std::vector<HierarchyTransport<N>::Inside> HierarchyTransport<N>::objects_inside() \
      const;                                                                                  \
  template HierarchyTransport<N>::BlockerPatches HierarchyTransport<N>::blocker_patches(      \
      float, float) const
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
