// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/low_discrepancy.h"
#include "lamina/base/core/vec.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/render/shading/dielectric_scattering.h"
#include "lamina/scene/surface/surface_point.h"

namespace lamina {

/// The boundary of a medium, smooth or rough, as a path inside meets it at a point.
struct WalkBoundary {
  DielectricScattering scattering;
  Framef frame;       ///< +z on the path's side
  Vec3f inner_facet;  ///< normal of the triangle, on the path's side
  Vec3f back;         ///< along the path, in the frame
};

/// Scattering at a rough boundary, any number of facets included.
/// @param eta  index beyond over index on the path's side
[[nodiscard]] DielectricScattering facet_scattering(float eta, const Interface& facets);

/// @param direction  of the path, towards the boundary
[[nodiscard]] WalkBoundary make_walk_boundary(const SurfacePoint& point, const Vec3f& direction,
                                              const DielectricScattering& scattering);

struct BoundaryTurn {
  Vec3f direction;
  bool passes = false;  ///< else it is reflected
  float pdf = 0.0f;     ///< near the density of the direction [1/sr]; 0 if there is but one
  float weight = 1.0f;  ///< on the throughput, for radiance over the square of the index; 0: lost
};
/// Samples where a path goes on.
[[nodiscard]] BoundaryTurn sample_turn(const WalkBoundary& boundary, PixelSamples& samples);

/// The value of the boundary's scattering for light from a direction beyond, times the cosine, and
/// the density with which a path samples that direction [1/sr]. 0 for smooth boundaries.
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
