// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/low_discrepancy.h"
#include "lamina/base/core/vec.h"
#include "lamina/layers/optics/rough/rough_interface.h"
#include "lamina/scene/description/scene.h"
#include "lamina/scene/surface/texture.h"

namespace lamina {

/// The boundary of a dielectric at one point, as a path followed from the eye meets it.
///
/// Directions are unit vectors in a frame whose +z is the side of the eye, wo.z > 0. Values are for
/// radiance over the square of the index of its medium: with L_i from wi and L_o to wo,
/// L_o / n_o^2 = integral of value * L_i / n_i^2 * |wi.z|. So the value is the bsdf of light that
/// goes the other way, from wo to wi; reciprocity has the factors n^2.
struct DielectricScattering {
  RoughInterface<double> interface;  ///< eta: index beyond over index on the side of the eye
  FacetScattering scattering = FacetScattering::single;
};

/// @param is_inside  whether the eye's side is the inside of the dielectric
[[nodiscard]] DielectricScattering dielectric_at(const TextureStore& textures,
                                                 const DielectricSurface& surface,
                                                 const SurfacePoint& point, bool is_inside);

/// value * |wi.z|, for multiple scattering an unbiased random estimate; 0 for smooth boundaries.
[[nodiscard]] float evaluate_dielectric(const DielectricScattering& boundary, const Vec3f& wo,
                                        const Vec3f& wi, PixelSamples& samples);

/// Density of sample_dielectric [1/sr]; for multiple scattering one that is near it, positive
/// wherever the value is.
[[nodiscard]] float pdf_dielectric(const DielectricScattering& boundary, const Vec3f& wo,
                                   const Vec3f& wi);

struct DielectricSample {
  Vec3f wi;
  float weight = 0.0f;  ///< value * |wi.z| / pdf, in [0, 1]; 0: lost
  float pdf = 0.0f;     ///< as pdf_dielectric; 0 if drawn from a single direction
};

[[nodiscard]] DielectricSample sample_dielectric(const DielectricScattering& boundary,
                                                 const Vec3f& wo, PixelSamples& samples);

}  // namespace lamina
