// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/rough_interface.h"

namespace lamina {
namespace {

/// What a facet does to light from wi to wo.
template <class T>
struct FacetEvent {
  BasicVec3<T> h;    ///< facet normal
  T wi_h{}, wo_h{};  ///< dot products; wo_h < 0 if transmitted
  T share{};         ///< Fresnel's fraction that goes this way, 0 if the facet cannot
  T jacobian{};      ///< solid angle of normals per solid angle of wo
};

template <class T>
FacetEvent<T> make_facet_event(const RoughInterface<T>& interface, const BasicVec3<T>& wi,
                               const BasicVec3<T>& wo) {
  FacetEvent<T> event{.h = half_vector(interface, wi, wo)};
  event.wi_h = dot(wi, event.h);
  event.wo_h = dot(wo, event.h);
  const bool is_reflection = wo.z > T{0};
  if (!(event.wi_h > T{0}) || (event.wo_h > T{0}) != is_reflection) return event;
  const T reflectance = fresnel(std::min(event.wi_h, T{1}), interface.eta);
  if (is_reflection) {
    event.share = reflectance;
    event.jacobian = T{1} / (T{4} * event.wo_h);
  } else {
    // [Walter2007] Eq. 17 divides by (wi.h + eta wo.h)^2, a difference; by Snell's law it equals
    // (1 - eta^2) over the sum.
    const T eta = interface.eta;
    const T sum = (event.wi_h - eta * event.wo_h) / ((eta - T{1}) * (eta + T{1}));
    event.share = T{1} - reflectance;
    event.jacobian = eta * eta * -event.wo_h * sum * sum;
  }
  return event;
}

/// Flux scattered to wo per solid angle and flux arriving from wi, but for the masking.
template <class T>
T unmasked_flux(const RoughInterface<T>& interface, const BasicVec3<T>& wi,
                const FacetEvent<T>& event) {
  return event.share > T{0} ? event.share * normal_density(interface.facets, event.h) *
                                  event.jacobian * event.wi_h / wi.z
                            : T{0};
}

}  // namespace

template <class T>
T brdf(const RoughInterface<T>& interface, const BasicVec3<T>& wi, const BasicVec3<T>& wo) {
  assert(wi.z > T{0});
  if (!(wo.z > T{0}) || is_specular(interface)) return T{0};
  const T flux = unmasked_flux(interface, wi, make_facet_event(interface, wi, wo));
  return flux > T{0} ? flux * masking_shadowing(interface.facets, wi, wo) / wo.z : T{0};
}

template <class T>
T btdf(const RoughInterface<T>& interface, const BasicVec3<T>& wi, const BasicVec3<T>& wo) {
  assert(wi.z > T{0});
  if (!(wo.z < T{0}) || is_specular(interface)) return T{0};
  const T flux = unmasked_flux(interface, wi, make_facet_event(interface, wi, wo));
  return flux > T{0} ? flux * masking_shadowing_through(interface.facets, wi, wo) / -wo.z : T{0};
}

template <class T>
T torrance_sparrow_brdf(const RoughInterface<T>& interface, const BasicVec3<T>& wi,
                        const BasicVec3<T>& wo) {
  assert(wi.z > T{0});
  if (!(wo.z > T{0}) || is_specular(interface)) return T{0};
  const FacetEvent<T> event = make_facet_event(interface, wi, wo);
  return unmasked_flux(interface, wi, event) * v_cavity_masking(wi, wo, event.h) / wo.z;
}

template <class T>
InterfaceSample<T> sample_rough_interface(const RoughInterface<T>& interface,
                                          const BasicVec3<T>& wi, T u1, T u2, T u3) {
  assert(wi.z > T{0});
  const bool specular = is_specular(interface);
  const BasicVec3<T> h = specular ? BasicVec3<T>{T{0}, T{0}, T{1}}
                                  : sample_visible_normal(interface.facets, wi, u1, u2);
  const T wi_h = std::clamp(dot(wi, h), T{0}, T{1});
  const T reflectance = fresnel(wi_h, interface.eta);
  const bool is_reflection = u3 < reflectance;
  const BasicVec3<T> wo =
      is_reflection ? reflect(wi, h) : refract(wi, h, interface.eta).value_or(reflect(wi, h));
  if (specular) return {.wo = wo, .weight = T{1}, .is_specular = true};
  if (is_reflection != (wo.z > T{0}) || wo.z == T{0}) return {.wo = wo};
  const T pdf = pdf_rough_interface(interface, wi, wo);
  if (!(pdf > T{0})) return {.wo = wo};
  const T seen = is_reflection ? masking_shadowing(interface.facets, wi, wo)
                               : masking_shadowing_through(interface.facets, wi, wo);
  return {.wo = wo,
          .weight = std::min(T{1}, seen * (T{1} + smith_lambda(interface.facets, wi))),
          .pdf = pdf};
}

template <class T>
T pdf_rough_interface(const RoughInterface<T>& interface, const BasicVec3<T>& wi,
                      const BasicVec3<T>& wo) {
  if (wo.z == T{0} || is_specular(interface)) return T{0};
  const FacetEvent<T> event = make_facet_event(interface, wi, wo);
  if (!(event.share > T{0})) return T{0};
  return event.share * pdf_visible_normal(interface.facets, wi, event.h) * event.jacobian;
}

#define LAMINA_INSTANTIATE(T)                                                          \
  template T brdf(const RoughInterface<T>&, const BasicVec3<T>&, const BasicVec3<T>&); \
  template T btdf(const RoughInterface<T>&, const BasicVec3<T>&, const BasicVec3<T>&); \
  template T torrance_sparrow_brdf(const RoughInterface<T>&, const BasicVec3<T>&,      \
                                   const BasicVec3<T>&);                               \
  template InterfaceSample<T> sample_rough_interface(const RoughInterface<T>&,         \
                                                     const BasicVec3<T>&, T, T, T);    \
  template T pdf_rough_interface(const RoughInterface<T>&, const BasicVec3<T>&, const BasicVec3<T>&)
LAMINA_INSTANTIATE(float);
LAMINA_INSTANTIATE(double);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
