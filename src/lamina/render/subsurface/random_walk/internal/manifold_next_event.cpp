// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/internal/manifold_next_event.h"

namespace lamina {
namespace {

constexpr float same_exit = 0.02f;  // distance of two exits that are one, over the path to them

}  // namespace

template <int N>
std::optional<typename ManifoldNextEvent<N>::SameConnection>
ManifoldNextEvent<N>::find_same_connection(const WalkPath<N>& path, const SurfacePoint& exit,
                                           const Ray& outside, const LightSeen& met,
                                           const FindBoundary* find_boundary) const {
  if (!path.has_scattered) return std::nullopt;
  LightSample sample{.direction = outside.direction, .distance = met.distance, .pdf = met.pdf};
  if (std::isfinite(met.distance)) {  // which the last event sees in another direction
    const Vec3f offset = outside.origin + met.distance * outside.direction - path.ray.origin;
    const float distance = length(offset);
    sample = {.direction = offset / distance, .distance = distance, .pdf = 0.0f};
    interior_.scene().lights.for_lights_seen({path.ray.origin, sample.direction}, 0.0f,
                                             1.001f * distance, false, [&](const LightSeen& seen) {
                                               if (seen.distance > 0.999f * distance)
                                                 sample.pdf = seen.pdf;
                                             });
  }
  std::optional<SameConnection> found;
  for_connections(path.ray.origin, sample, find_boundary, [&](const RefractedEntry& entry) {
    if (length(entry.point.position - exit.position) <
        same_exit * entry.length + least_distance(interior_.scene()))
      found = {entry, sample.pdf * interior_.ior() * interior_.ior() / entry.geometry_term};
  });
  return found;
}

template class ManifoldNextEvent<4>;
template class ManifoldNextEvent<8>;
template class ManifoldNextEvent<16>;

}  // namespace lamina
