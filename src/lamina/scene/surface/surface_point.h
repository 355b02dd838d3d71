// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/surface/ray.h"

namespace lamina {

/// A point on a surface, with all that textures and scattering ask of it. Normals point outward,
/// unless it is turned over.
struct SurfacePoint {
  Vec3f position;          ///< [mm]
  Vec3f geometric_normal;  ///< of the triangle, unit length
  Vec3f smooth_normal;     ///< interpolated between the vertices, unit length
  Vec3f normal;            ///< smooth_normal, bent by bump and normal maps
  Vec3f du, dv;            ///< change of position per unit of u and v [mm]; 0 without coordinates
  Vec2f uv;
  Vec2f uv_middle;            ///< of its triangle, which says the UDIM tile
  Vec3f color{1, 1, 1};       ///< of the vertices
  float footprint = 0.0f;     ///< width of the region that is seen [mm]
  float uv_footprint = 0.0f;  ///< the same in texture coordinates
  std::uint32_t mesh = 0, triangle = 0, material = 0;
  bool is_below = false;  ///< of a sheet: on the side of the last layer
};

/// The point seen from the other side: its normals are turned round.
/// @param is_sheet  whether that side is another one of the layers, which light passes
[[nodiscard]] inline SurfacePoint turned_over(SurfacePoint point, bool is_sheet) {
  point.geometric_normal = -point.geometric_normal;
  point.smooth_normal = -point.smooth_normal;
  point.normal = -point.normal;
  point.is_below = is_sheet && !point.is_below;
  return point;
}

/// @param footprint  width of the region that the point stands for [mm]
[[nodiscard]] SurfacePoint make_surface_point(const std::vector<Mesh>& meshes, const Hit& hit,
                                              float footprint);

/// Makes a point without what textures ask of it: du, dv, uv and footprints are 0.
[[nodiscard]] SurfacePoint make_bare_surface_point(const std::vector<Mesh>& meshes, const Hit& hit);

/// The origin of a ray that leaves `point` towards `direction` without meeting its own triangle.
[[nodiscard]] Vec3f leave_surface(const SurfacePoint& point, const Vec3f& direction);

}  // namespace lamina
