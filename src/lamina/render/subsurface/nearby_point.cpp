// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/nearby_point.h"

#include <cmath>

namespace lamina {

SurfacePoint nearby_point(const RenderScene& scene, std::uint32_t material,
                          const SurfacePoint& point, Vec2f offset, float reach) {
  const Framef frame = make_frame(point.smooth_normal);
  const Vec3f place = point.position + offset.x * frame.x + offset.y * frame.y;
  ProbeHits found;
  scene.geometry.all_hits({place + reach * frame.z, -frame.z}, 2.0f * reach, material, found);
  SurfacePoint nearest = point;
  float least = reach;
  for (const Hit& hit : found.all()) {
    const float height = std::abs(reach - hit.distance);
    if (!(height < least)) continue;
    const SurfacePoint candidate = make_surface_point(scene.scene->meshes, hit, point.footprint);
    if (!(dot(candidate.geometric_normal, frame.z) > 0.0f)) continue;
    least = height;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace lamina
