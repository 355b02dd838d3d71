// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/shading/shadow_transmittance.h"

#include <algorithm>
#include <cmath>

#include "lamina/layers/optics/fresnel.h"

namespace lamina {

float opacity_at(const RenderScene& scene, const SurfacePoint& point) {
  const auto& opacity = scene.scene->materials[point.material].opacity;
  return opacity ? std::clamp(scene.textures.scalar(*opacity, point), 0.0f, 1.0f) : 1.0f;
}

template <int N>
BandValues<N> straight_through(const RenderScene& scene, const ThinSheet<N>& sheet,
                               const SurfacePoint& point, const Vec3f& direction) {
  SurfacePoint entry = point;
  entry.is_below = dot(direction, point.geometric_normal) > 0.0f;
  const float cos_i = std::min(std::abs(dot(direction, point.smooth_normal)), 1.0f);
  const float entered = 1.0f - reflectance(boundary_at(scene, entry), cos_i);
  return entered *
         sheet.fractions(sheet.place_at(scene.textures, point), entry.is_below ? 1 : 0, cos_i)
             .straight;
}

template <int N>
BandValues<N> shadow_transmittance(const RenderScene& scene, const ThinSheets<N>& sheets,
                                   const Ray& ray, float t_far, Dielectrics dielectrics) {
  using Bands = BandValues<N>;
  if (!scene.has_clear_surfaces)
    return Bands::filled(scene.geometry.is_blocked(ray, 0.0f, t_far) ? 0.0f : 1.0f);
  Bands fraction = Bands::filled(1.0f);
  float t_near = 0.0f;
  for (int surfaces = 0; surfaces < 32; ++surfaces) {
    const Hit hit = scene.geometry.first_hit(ray, t_near, t_far);
    if (!hit.is_hit()) return fraction;
    const SurfacePoint point = make_surface_point(scene.scene->meshes, hit, 0.0f);
    const SurfaceMaterial& material = scene.scene->materials[point.material];
    const float opacity = opacity_at(scene, point);
    Bands through = Bands::filled(1.0f - opacity);
    if (const auto* glass = std::get_if<DielectricSurface>(&material.surface)) {
      if (dielectrics == Dielectrics::block) return {};
      // As through a parallel plate: each face by its reflectance from outside, which equals that
      // from inside along the refracted ray.
      const float cos_i = std::min(std::abs(dot(ray.direction, point.smooth_normal)), 1.0f);
      through = Bands::filled(1.0f - fresnel(cos_i, glass->ior));
    } else if (const auto& sheet = sheets[point.material]) {
      through += opacity * straight_through(scene, *sheet, point, ray.direction);
    }
    fraction *= through;
    if (!(largest(fraction) > 0.0f)) return {};
    t_near = distance_behind(hit, point);
  }
  return {};
}

#define LAMINA_INSTANTIATE(N)                                                           \
  template BandValues<N> straight_through(const RenderScene&, const ThinSheet<N>&,      \
                                          const SurfacePoint&, const Vec3f&);           \
  template BandValues<N> shadow_transmittance(const RenderScene&, const ThinSheets<N>&, \
                                              const Ray&, float, Dielectrics)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
