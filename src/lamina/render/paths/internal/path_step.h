// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/core/low_discrepancy.h"
#include "lamina/render/paths/internal/path_surface.h"

namespace lamina {

/// Light from one light sample, mirrored and, if asked for, scattered by the base.
template <int N>
struct Reflected {
  BandValues<N> specular, base;
};

/// Without the base lights are chosen by what the boundary mirrors of them.
///
/// @param specular_chance, base_chance  with which `scatter` draws by the boundary and by the base
template <int N>
[[nodiscard]] Reflected<N> direct_light(const PathWorld<N>& world, const PathSurface<N>& surface,
                                        bool with_base, float specular_chance, float base_chance,
                                        PixelSamples& samples);

/// What lights that are chosen by a mirror are worth, in candidates of others.
template <int N>
[[nodiscard]] float specular_light_candidates(const PathWorld<N>& world) {
  return world.scene.lights.cluster_count() > 0 ? product_sampling_candidates : light_candidates;
}

/// Turns a path at a diffuse or coated surface, by the boundary with the given chance; false if it
/// ends there.
template <int N>
[[nodiscard]] bool scatter(const PathSurface<N>& surface, float chance, Ray& ray, Path& path,
                           BandValues<N>& throughput, bool& is_specular, PixelSamples& samples);

/// Adds the light that a dielectric scatters towards the eye, and turns the path there; false if it
/// ends.
template <int N>
[[nodiscard]] bool scatter_at_dielectric(const PathWorld<N>& world, const SurfacePoint& point,
                                         const DielectricSurface& glass, Ray& ray, Path& path,
                                         BandValues<N>& throughput, BandValues<N>& radiance,
                                         PixelSamples& samples);

}  // namespace lamina
