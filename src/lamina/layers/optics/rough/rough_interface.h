// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/vec.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/layers/optics/rough/microfacet.h"

namespace lamina {

/// A rough boundary between two dielectrics, as facets that each reflect and refract like a smooth
/// interface. Light that meets more than one facet is left out and so lost. Of diffuse light at
/// index 1.4 that is, with Beckmann's (GGX's) facets:
///
///     alpha                 0.1            0.3            0.5            1
///     from outside     .003 (.008)    .012 (.041)    .021 (.099)    .086 (.29)
///     from inside      .006 (.034)    .055 (.17)     .14  (.31)     .35  (.54)
///
/// Directions are unit vectors away from the surface in a frame whose +z is the side of wi: wi.z >
/// 0 always, reflected directions have wo.z > 0, transmitted ones wo.z < 0. For light from the
/// other side turn the frame over and take 1 / eta. Light arrives from wi and leaves to wo.
template <class T>
struct RoughInterface {
  Microfacets<T> facets;
  T eta = T(1.4);  ///< refractive index beyond the interface over that on the side of wi, > 0
};

/// The interface of a layer stack as seen by light that passes from index `ior_before` to
/// `ior_beyond`.
template <class T>
[[nodiscard]] RoughInterface<T> make_rough_interface(const Interface& boundary, double ior_before,
                                                     double ior_beyond) {
  return {.facets = {T(boundary.roughness), boundary.distribution},
          .eta = T(ior_beyond / ior_before)};
}

/// Whether light goes on in the mirror and refracted directions alone: roughness below 1e-4, or
/// matched indices, where nothing is seen of the facets. Then every function below has the value 0,
/// and the sampler draws from the two directions.
template <class T>
[[nodiscard]] bool is_specular(const RoughInterface<T>& interface) {
  return interface.facets.alpha < T(1e-4) || std::abs(interface.eta - T{1}) < T(1e-6);
}

/// Normal of the facet that mirrors wi to wo, or refracts it if wo.z < 0; on the side of wi, z > 0.
template <class T>
[[nodiscard]] BasicVec3<T> half_vector(const RoughInterface<T>& interface, const BasicVec3<T>& wi,
                                       const BasicVec3<T>& wo) {
  const BasicVec3<T> h = wo.z > T{0} ? wi + wo : wi + interface.eta * wo;
  const T norm = length(h);
  return norm > T{0} ? std::copysign(T{1} / norm, h.z) * h : BasicVec3<T>{T{0}, T{0}, T{1}};
}

/// Radiance reflected to wo per irradiance from wi [1/sr]; symmetric in wi and wo.
///
/// Source: [Walter2007] Eq. 20 with the height-correlated masking of [Heitz2014].
template <class T>
[[nodiscard]] T brdf(const RoughInterface<T>& interface, const BasicVec3<T>& wi,
                     const BasicVec3<T>& wo);

/// Radiance transmitted to wo per irradiance from wi [1/sr].
///
/// Reciprocity: btdf(wi, wo) = eta^2 btdf'(wo, wi), the prime for the interface turned over, so a
/// path followed from the eye takes btdf'(eye, light) * eta^2.
///
/// Source: [Walter2007] Eq. 21 with the masking of [Heitz2016].
template <class T>
[[nodiscard]] T btdf(const RoughInterface<T>& interface, const BasicVec3<T>& wi,
                     const BasicVec3<T>& wo);

/// brdf or btdf, by the side of wo.
template <class T>
[[nodiscard]] T bsdf(const RoughInterface<T>& interface, const BasicVec3<T>& wi,
                     const BasicVec3<T>& wo) {
  return wo.z > T{0} ? brdf(interface, wi, wo) : btdf(interface, wi, wo);
}

/// The oil coat of [HanrahanKrueger1993] and the rough top of [DonnerJensen2005]: reflection by the
/// facets with the masking of V-shaped grooves in place of Smith's [1/sr].
///
/// Source: [TorranceSparrow1967], with the Fresnel factor of the facet.
template <class T>
[[nodiscard]] T torrance_sparrow_brdf(const RoughInterface<T>& interface, const BasicVec3<T>& wi,
                                      const BasicVec3<T>& wo);

/// A direction drawn from an interface.
template <class T>
struct InterfaceSample {
  BasicVec3<T> wo;  ///< reflected if wo.z > 0, else transmitted
  T weight = T{0};  ///< bsdf * |wo.z| / pdf, in [0, 1]; 0 where the light meets more facets
  T pdf = T{0};     ///< [1/sr], as pdf_rough_interface gives it; 0 if is_specular
  bool is_specular = false;  ///< drawn from a single direction: weight counts, pdf and bsdf do not
};

/// Draws wo: a facet seen from wi, then reflection or refraction as Fresnel's law has it.
///
/// @param u1, u2, u3  uniform in [0, 1); u3 chooses between the two.
template <class T>
[[nodiscard]] InterfaceSample<T> sample_rough_interface(const RoughInterface<T>& interface,
                                                        const BasicVec3<T>& wi, T u1, T u2, T u3);

/// Density of sample_rough_interface over the sphere [1/sr]. It integrates to less than 1: samples
/// that meet more facets have weight 0 and wo on the wrong side of the mean plane.
template <class T>
[[nodiscard]] T pdf_rough_interface(const RoughInterface<T>& interface, const BasicVec3<T>& wi,
                                    const BasicVec3<T>& wo);

}  // namespace lamina
