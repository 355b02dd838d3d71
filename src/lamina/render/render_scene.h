// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "lamina/render/lights.h"
#include "lamina/render/ray_geometry.h"
#include "lamina/render/scene.h"
#include "lamina/render/surface_boundary.h"
#include "lamina/render/surface_point.h"
#include "lamina/render/texture.h"

namespace lamina {

/// A scene with all that paths ask of it precomputed, whatever the bands.
struct RenderScene {
  /// The boundaries of one material. A coat stands in for the material's own surface where it
  /// lies: its reflection takes the place of the other, so no light is reflected by both.
  struct Boundaries {
    std::unique_ptr<BoundaryReflectance> coat;
    std::unique_ptr<BoundaryReflectance> own;  ///< of a translucent material, unless matched
    float own_roughness = 0.0f;
  };

  /// `scene` must outlive the result.
  /// @throws InvalidInput if a triangle or map points to what is not there.
  explicit RenderScene(const Scene& from);

  const Scene* scene;
  RayGeometry geometry;
  TextureStore textures;
  Lights lights;
  std::vector<Boundaries> boundaries;  ///< [material]
  bool has_dielectrics = false;        ///< which shadow rays pass
};

/// The boundary over the base at a point.
[[nodiscard]] SurfaceBoundary boundary_at(const RenderScene& scene, const SurfacePoint& point);

/// The surface at a hit, its normal bent by the material's bump and normal maps.
[[nodiscard]] SurfacePoint surface_at(const RenderScene& scene, const Hit& hit, float footprint);

/// Fraction of light that comes straight through between two distances along a ray: 0 behind an
/// opaque surface. A dielectric lets through what it does not reflect and bends nothing: for light
/// on other surfaces its focusing is left out, which keeps the image clean.
[[nodiscard]] float clear_fraction(const RenderScene& scene, const Ray& ray, float t_far);

}  // namespace lamina
