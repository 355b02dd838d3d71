// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/core/low_discrepancy.h"
#include "lamina/core/vec.h"
#include "lamina/optics/layer_stack.h"
#include "lamina/render/shading/dielectric_scattering.h"
#include "lamina/surface/surface_point.h"

namespace lamina {

/// The boundary of a medium, smooth or rough, as a path inside meets it at a point. Light that
/// meets several facets is followed until it leaves them, so that nothing is lost.
struct WalkBoundary {
  DielectricScattering scattering;
  Framef frame;       ///< +z on the path's side
  Vec3f inner_facet;  ///< normal of the triangle, on the path's side
  Vec3f back;         ///< along the path, in the frame
};

/// @param direction  of the path, towards the boundary
/// @param eta        index beyond over index on the path's side
[[nodiscard]] WalkBoundary make_walk_boundary(const SurfacePoint& point, const Vec3f& direction,
                                              float eta, const Interface& facets);

struct BoundaryTurn {
  Vec3f direction;
  bool passes = false;  ///< else it is mirrored
  float pdf = 0.0f;     ///< near the density of the direction [1/sr]; 0 if there is but one
};
/// Draws where a path goes on, by what light that comes from there has in common with it: with
/// weight 1 for radiance over the square of the index.
[[nodiscard]] BoundaryTurn sample_turn(const WalkBoundary& boundary, PixelSamples& samples);

/// Of light from a direction beyond that takes the path, by chance: what a path draws it with, as
/// a density [1/sr]. 0 for smooth boundaries.
struct BoundaryLight {
  float value = 0.0f;  ///< an unbiased estimate
  float pdf = 0.0f;    ///< as that of the turn
};
[[nodiscard]] BoundaryLight light_through(const WalkBoundary& boundary, const Vec3f& to_light,
                                          PixelSamples& samples);

/// A direction inside for a ray that comes from the eye and enters.
///
/// @param to_eye  in the hemisphere of `normal`
/// @return        0 if none was found
[[nodiscard]] Vec3f sample_entry(const Vec3f& to_eye, const Vec3f& normal, float ior,
                                 const Interface& facets, PixelSamples& samples);

}  // namespace lamina
