// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/vec.h"
#include "lamina/layers/optics/rough/rough_interface.h"

namespace lamina {

/// A rough surface between two dielectrics as [XuSun2008] see it: Gaussian heights of RMS sigma
/// whose correlation over the distance r is exp(-r^2 / tau^2).
///
/// Its slopes are Gaussian too, so its facets are Beckmann's with roughness 2 / s. The model
/// differs from `RoughInterface` in how facets hide one another. Frames and sides are those of
/// `RoughInterface`.
struct GaussianSurface {
  double smoothness = 3.0;  ///< s = tau / sigma, > 0; 6 is fine frost, 0.5 a wild surface
  double eta = 1.4;  ///< refractive index beyond the surface over that on the side of wi, > 0
};

/// The facets of the surface.
[[nodiscard]] inline RoughInterface<double> make_rough_interface(const GaussianSurface& surface) {
  return {.facets = {.alpha = 2.0 / surface.smoothness}, .eta = surface.eta};
}

/// Probability V(0, theta) that a facet at mean height is seen from the direction w above it.
///
/// Source: [XuSun2008] Eq. 24. The printed exponent can be read two ways; it is s^2 / (4 tan^2).
[[nodiscard]] double visibility(const GaussianSurface& surface, const Vec3& w);

/// Radiance to wo, by one refraction, per irradiance from wi [1/sr].
///
/// Good for s >= 3 and theta_i below 60 degrees. For rougher surfaces it misses the light scattered
/// more than once; docs/rough_surfaces.md has the errors against ray-traced height fields.
///
/// Source: [XuSun2008] Eq. 25.
[[nodiscard]] double single_scattering_btdf(const GaussianSurface& surface, const Vec3& wi,
                                            const Vec3& wo);

/// Radiance to wo, by one reflection, per irradiance from wi [1/sr]. Source: [Sun2007].
[[nodiscard]] double single_scattering_brdf(const GaussianSurface& surface, const Vec3& wi,
                                            const Vec3& wo);

/// Either, by the side of wo.
[[nodiscard]] inline double single_scattering_bsdf(const GaussianSurface& surface, const Vec3& wi,
                                                   const Vec3& wo) {
  return wo.z > 0.0 ? single_scattering_brdf(surface, wi, wo)
                    : single_scattering_btdf(surface, wi, wo);
}

/// Draws wo by a facet seen from wi and Fresnel's choice; the density is pdf_rough_interface of
/// make_rough_interface(surface), the weight bsdf * |wo.z| / pdf lies in [0, 1].
///
/// @param u1, u2, u3  uniform in [0, 1).
[[nodiscard]] InterfaceSample<double> sample_single_scattering(const GaussianSurface& surface,
                                                               const Vec3& wi, double u1, double u2,
                                                               double u3);

/// Fractions of the flux from a direction of cosine cos_i, in (0, 1], that a surface reflects and
/// transmits by one scattering event; the rest meets more facets. Exact to 1e-4.
struct SingleScatteringFractions {
  double reflectance, transmittance;
};
[[nodiscard]] SingleScatteringFractions single_scattering_fractions(const GaussianSurface& surface,
                                                                    double cos_i);

}  // namespace lamina
