// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "lamina/layers/optics/rough/surface_boundary.h"
#include "lamina/render/geometry/ray_geometry.h"
#include "lamina/render/kept/kept_parts.h"
#include "lamina/render/lights/lights.h"
#include "lamina/scene/description/scene.h"
#include "lamina/scene/surface/surface_point.h"
#include "lamina/scene/surface/texture.h"

namespace lamina {

/// A scene with all that paths ask of it precomputed, whatever the bands.
struct RenderScene {
  /// The boundary on top of a covering; no table where the indices are equal.
  struct CoveringTop {
    std::shared_ptr<const BoundaryReflectance> table;
    float roughness = 0.0f;
  };

  /// The boundaries of one material. A coat stands in for the material's own surface where it
  /// lies: its reflection takes the place of the other, so no light is reflected by both.
  struct Boundaries {
    std::shared_ptr<const BoundaryReflectance> coat;
    std::shared_ptr<const BoundaryReflectance> own;  ///< of a translucent material, unless matched
    std::shared_ptr<const BoundaryReflectance> own_below;  ///< of finite layers, their other side
    float own_roughness = 0.0f, own_roughness_below = 0.0f;
    std::vector<CoveringTop> over;  ///< [covering]
  };

  /// @param from      must outlive the result
  /// @param settings  in place of the scene's own, whose method may be left open
  /// @param kept      parts of other pictures of this scene as it was; null: none. Outlives it.
  /// @throws InvalidInput if a triangle or map points to what is not there, or for a map that the
  ///         method does not have.
  RenderScene(const Scene& from, const RenderSettings& settings, KeptParts* kept = nullptr);
  explicit RenderScene(const Scene& from) : RenderScene(from, from.render) {}

  const Scene* scene;
  RenderSettings settings;
  KeptParts* kept;
  std::shared_ptr<const void> meshes_of_geometry;  ///< where that was kept
  RayGeometry geometry;
  TextureStore textures;
  Lights lights;
  std::vector<Boundaries> boundaries;  ///< [material]
  /// [material] of method layered_bsdf: maps of layers, and of the material's numbers as such
  std::vector<std::vector<LayerMap>> layer_maps;
  bool has_clear_surfaces = false;  ///< which shadow rays pass: dielectric, thin or cut out
};

/// The boundary over the base at a point, on the side of it that the point is on.
[[nodiscard]] SurfaceBoundary boundary_at(const RenderScene& scene, const SurfacePoint& point);

/// The surface at a hit, its normal bent by the material's bump and normal maps.
[[nodiscard]] SurfacePoint surface_at(const RenderScene& scene, const Hit& hit, float footprint);

/// Where to look for the next surface along a ray that goes on behind a hit [mm].
[[nodiscard]] inline float distance_behind(const Hit& hit, const SurfacePoint& point) {
  return hit.distance + 1e-5f * std::max(hit.distance, length(point.position));
}

}  // namespace lamina
