// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/gaussian_surface.h"

#include "lamina/layers/optics/rough/facet_lattice.h"

namespace lamina {
namespace {

/// What every term has but the masking: the scattering of facets that do not hide one another.
double unmasked_bsdf(const GaussianSurface& surface, const Vec3& wi, const Vec3& wo) {
  const RoughInterface<double> interface = make_rough_interface(surface);
  const double seen = projected_facet_area(interface.facets, wi);
  return pdf_rough_interface(interface, wi, wo) * seen / (wi.z * std::abs(wo.z));
}

}  // namespace

double visibility(const GaussianSurface& surface, const Vec3& w) {
  const double s = surface.smoothness;
  const double tan_theta = std::sqrt(w.x * w.x + w.y * w.y) / std::abs(w.z);
  if (tan_theta < 0.02 * s) return 1.0;  // the exponential is below 1e-270
  const double a = 0.5 * s / tan_theta;
  constexpr double k0 = 0.7;
  return std::exp(-k0 * tan_theta / s * std::exp(-a * a));
}

double single_scattering_btdf(const GaussianSurface& surface, const Vec3& wi, const Vec3& wo) {
  assert(wi.z > 0.0);
  if (!(wo.z < 0.0)) return 0.0;
  return unmasked_bsdf(surface, wi, wo) * visibility(surface, wi) * visibility(surface, wo);
}

double single_scattering_brdf(const GaussianSurface& surface, const Vec3& wi, const Vec3& wo) {
  assert(wi.z > 0.0);
  if (!(wo.z > 0.0)) return 0.0;
  return unmasked_bsdf(surface, wi, wo) * visibility(surface, wi) * visibility(surface, wo);
}

InterfaceSample<double> sample_single_scattering(const GaussianSurface& surface, const Vec3& wi,
                                                 double u1, double u2, double u3) {
  const RoughInterface<double> interface = make_rough_interface(surface);
  InterfaceSample<double> sample = sample_rough_interface(interface, wi, u1, u2, u3);
  if (sample.pdf > 0.0)
    sample.weight = projected_facet_area(interface.facets, wi) / wi.z * visibility(surface, wi) *
                    visibility(surface, sample.wo);
  return sample;
}

SingleScatteringFractions single_scattering_fractions(const GaussianSurface& surface,
                                                      double cos_i) {
  const RoughInterface<double> interface = make_rough_interface(surface);
  const Vec3 wi = {std::sqrt(1.0 - cos_i * cos_i), 0.0, cos_i};
  SingleScatteringFractions sum{};
  detail::for_each_visible_facet<28657, 17711>(
      interface.facets, wi, [&](const Vec3& h, double weight) {
        const double f = fresnel(std::clamp(dot(wi, h), 0.0, 1.0), surface.eta);
        if (const Vec3 wo = reflect(wi, h); wo.z > 0.0)
          sum.reflectance += weight * f * visibility(surface, wo);
        if (const auto wo = refract(wi, h, surface.eta); wo && wo->z < 0.0)
          sum.transmittance += weight * (1.0 - f) * visibility(surface, *wo);
      });
  const double arriving =
      projected_facet_area(interface.facets, wi) / cos_i * visibility(surface, wi);
  return {arriving * sum.reflectance, arriving * sum.transmittance};
}

}  // namespace lamina
