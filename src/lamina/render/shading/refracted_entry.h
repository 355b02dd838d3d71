// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "lamina/base/core/vec.h"
#include "lamina/render/lights/lights.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/scene/surface/surface_point.h"

namespace lamina {

/// A connection through refraction, for next-event estimation from inside: where light enters a
/// smooth boundary so that it passes a given point inside.
struct RefractedEntry {
  SurfacePoint point;           ///< without what textures ask of it
  Hit hit;                      ///< the place of the point on its mesh
  Vec3f to_light;               ///< outside, unit length
  float light_distance = 0.0f;  ///< from the entry [mm]
  Vec3f to_surface;             ///< inside, from the given point's side, refracted; unit length
  float length = 0.0f;          ///< of the path inside [mm]
  float cos_outside = 0.0f, cos_inside = 0.0f;  ///< from the normal, > 0
  float geometry_term = 0.0f;  ///< irradiance across the beam at the given point over that across
                               ///< the beam outside, as the light sample states it for the given
                               ///< point; without what is reflected or absorbed
  float reflectance = 1.0f;    ///< of a flat surface that reflects the path inside, if any
};

/// How far from a surface that a ray leaves the next one can be at least [mm]: the rounding of rays
/// and triangles, whose size counts too.
[[nodiscard]] inline float least_distance(const RenderScene& scene) {
  return 2e-6f * length(scene.geometry.box_high() - scene.geometry.box_low());
}

/// The direction inside of light from (or to) `outside`, both away from the middle between them:
/// `outside` is in the hemisphere of n, and so is the result, the continuation of the ray inside
/// turned back.
[[nodiscard]] Vec3f refract_inside(const Vec3f& outside, const Vec3f& n, float ior);

/// The entry on the straight line to a light, its path inside shortened as if the boundary were
/// flat: exact there for a light far away.
///
/// @param light  as seen from the point inside
/// @return       nothing if anything else than the boundary of the material is met first
///
/// Source: [Hery2003] §2, s'_i.
[[nodiscard]] std::optional<RefractedEntry> find_straight_entry(const RenderScene& scene,
                                                                const Vec3f& inside,
                                                                std::uint32_t material, float ior,
                                                                const LightSample& light);

/// The entry on the path that Snell's law takes, with the focusing of the curved boundary: Newton's
/// method on the smooth normals, from where a ray towards `first` leaves. For a light at a finite
/// distance the change of its own cosine along the way is left out, second order in depth over
/// distance.
///
/// @return  nothing if it does not converge. The same arguments give the same result.
///
/// Source: the derivatives are ray differentials, [Igehy1999] §3; the search is a walk on a
/// specular manifold of one vertex, [JakobMarschner2012] §4: manifold next-event estimation.
[[nodiscard]] std::optional<RefractedEntry> find_refracted_entry(const RenderScene& scene,
                                                                 const Vec3f& inside,
                                                                 std::uint32_t material, float ior,
                                                                 const LightSample& light,
                                                                 const Vec3f& first);

/// Where a ray from inside, in a direction, meets the boundary that refracts.
struct BoundaryHit {
  SurfacePoint point;
  Hit hit;
};
using FindBoundary = std::function<std::optional<BoundaryHit>(const Vec3f& direction)>;

/// Like find_refracted_entry, through a boundary that is not the first surface on the way.
[[nodiscard]] std::optional<RefractedEntry> find_refracted_entry(
    const RenderScene& scene, const Vec3f& inside, const FindBoundary& find_boundary, float ior,
    const LightSample& light, const Vec3f& first);

/// Whether the boundary is flat at a point, as far as its normals tell.
[[nodiscard]] bool is_flat(const SurfacePoint& point);

/// Like find_refracted_entry for a path that a flat part of the boundary reflects once on its way
/// inside: that of the given point's image in it.
///
/// @param mirror  where it is, as met from inside
/// @param first   from the image: towards where the light enters
[[nodiscard]] std::optional<RefractedEntry> find_reflected_entry(
    const RenderScene& scene, const Vec3f& inside, const SurfacePoint& mirror, float ior,
    const LightSample& light, const Vec3f& first);

}  // namespace lamina
