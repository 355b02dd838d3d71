// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/random.h"
#include "lamina/layers/optics/rough/rough_interface.h"

namespace lamina {

// A rough interface with all the light that meets several facets, reflected and refracted any
// number of times. It loses nothing: reflected and transmitted light add up to what arrives. Frames
// and sides are those of `RoughInterface`, whose bsdf is the part of order 1.
//
// Source: [Heitz2016]: a random walk over facets at independent heights, Smith's assumption.

/// A direction drawn in proportion to bsdf * |wo.z|, so with weight 1.
struct MultipleScatteringSample {
  Vec3 wo;        ///< reflected if wo.z > 0, else transmitted
  int order = 0;  ///< facets met, >= 1; 0 if the walk was given up after 10000 of them
};

/// Follows light that arrives from wi until it leaves. Interfaces that are smooth or matched work
/// too.
[[nodiscard]] MultipleScatteringSample sample_multiple_scattering(
    const RoughInterface<double>& interface, const Vec3& wi, Random& random);

/// Radiance to wo per irradiance from wi by light of all orders [1/sr]: the closed form for order 1
/// and an unbiased random estimate for the others. 0 for smooth or matched interfaces.
///
/// Reciprocal in the mean, as bsdf is: use the order of arguments that btdf describes.
[[nodiscard]] double evaluate_multiple_scattering(const RoughInterface<double>& interface,
                                                  const Vec3& wi, const Vec3& wo, Random& random);

/// A density near that of sample_multiple_scattering [1/sr], for weights between sampling
/// techniques, where any positive density serves: the part of order 1 and a cosine lobe on each
/// side that has the missing flux.
///
/// @param single_scattered  flux of order 1, in [0, 1], as from InterfaceReflectance.
[[nodiscard]] double approximate_pdf_multiple_scattering(const RoughInterface<double>& interface,
                                                         const Vec3& wi, const Vec3& wo,
                                                         double single_scattered);

}  // namespace lamina
