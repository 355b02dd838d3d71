// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/low_discrepancy.h"
#include "lamina/render/paths/internal/path_surface.h"

namespace lamina {

/// Radiance of a path where it meets a surface, and how it is continued. Radiances are towards the
/// path's ray, its throughput aside.
template <int N>
struct PathStep {
  BandValues<N> inside;          ///< from inside a translucent object
  BandValues<N> specular, base;  ///< direct light that the boundary mirrors, that the base scatters
  bool is_subsurface = false;    ///< whether inside and base are light from below the surface

  bool continues = false;
  bool is_specular = false;  ///< continued by the boundary
  Vec3f direction;
  BandValues<N> weight;     ///< on the throughput: bsdf * cos / pdf
  float pdf = 0.0f;         ///< [1/sr]; 0 for a delta direction
  float spread = 0.0f;      ///< of the path from here, as PathState has it
  float candidates = 0.0f;  ///< of next-event estimation here, for MIS weights
};

/// Next-event estimation at a surface, and a sampled direction.
///
/// @param path      that met the surface
/// @param gatherer  of the light that enters translucent objects
template <int N>
[[nodiscard]] PathStep<N> make_path_step(const PathWorld<N>& world, const PathSurface<N>& surface,
                                         const PathState<N>& path, const LightGatherer<N>& gatherer,
                                         PixelSamples& samples);

/// Adds the light that a dielectric scatters towards the eye, and continues the path there by
/// reflection or refraction; false if it ends.
template <int N>
[[nodiscard]] bool scatter_at_dielectric(const PathWorld<N>& world, const SurfacePoint& point,
                                         const DielectricSurface& glass, PathState<N>& path,
                                         PixelSamples& samples);

}  // namespace lamina
