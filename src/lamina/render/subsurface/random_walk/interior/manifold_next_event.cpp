// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/interior/manifold_next_event.h"

namespace lamina {
template <int N>
std::optional<SurfacePoint> ManifoldNextEvent<N>::meet(const Vec3f& inside, const Vec3f& direction,
                                                       const Vec3f& n) const {
  const RenderScene& scene = interior_.scene();
  const Hit hit = scene.geometry.first_hit({inside, direction}, 0.0f);
  if (!hit.is_hit()) return std::nullopt;
  const SurfacePoint point = make_bare_surface_point(scene.scene->meshes, hit);
  if (differ(point.smooth_normal, n)) return std::nullopt;
  return point;
}

template <int N>
std::optional<typename ManifoldNextEvent<N>::SameConnection>
ManifoldNextEvent<N>::find_same_connection(const WalkPath<N>& path, const SurfacePoint& exit,
                                           const Ray& outside, const LightSeen& met,
                                           const FindBoundary* find_boundary) const {
  if (!path.has_scattered && !path.is_reflected_once) return std::nullopt;
  const Vec3f& inside = path.last.ray.origin;
  LightSample sample{.direction = outside.direction, .distance = met.distance, .pdf = met.pdf};
  if (std::isfinite(met.distance)) {  // which the last event sees in another direction
    const Vec3f offset = outside.origin + met.distance * outside.direction - inside;
    const float distance = length(offset);
    sample = {.direction = offset / distance, .distance = distance};
    sample.pdf = interior_.scene().lights.pdf_of_area_light(inside, sample.direction, distance);
  }
  std::optional<SameConnection> found;
  const auto compare = [&](const RefractedEntry& entry) {
    if (is_same_entry(entry.point.position, exit.position, entry.length))
      found = {entry, sample.pdf * interior_.ior() * interior_.ior() / entry.geometry_term};
  };
  if (path.has_scattered)
    for_connections(inside, sample, find_boundary, compare);
  else if (finds_reflected_)
    for_reflected_connections(inside, sample, compare);
  return found;
}

template <int N>
bool ManifoldNextEvent<N>::finds(const Vec3f& event, int reflections, const SurfacePoint& entry,
                                 const Ray& outside, const LightSeen& light) const {
  WalkPath<N> path;
  path.last.ray.origin = event;
  path.has_scattered = reflections == 0;
  path.is_reflected_once = reflections == 1;
  return find_same_connection(path, entry, outside, light, nullptr).has_value();
}

template class ManifoldNextEvent<4>;
template class ManifoldNextEvent<8>;
template class ManifoldNextEvent<16>;

}  // namespace lamina
