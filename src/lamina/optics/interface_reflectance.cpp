// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/optics/interface_reflectance.h"

#include "lamina/optics/facet_lattice.h"

namespace lamina {
namespace {

constexpr int cosines = 129;  // odd, for Simpson's rule

struct Fractions {
  double reflectance = 0.0, transmittance = 0.0;
};

Fractions smooth_fractions(double cos_i, double eta) {
  const double f = fresnel(cos_i, eta);
  return {f, 1.0 - f};
}

Fractions rough_fractions(const RoughInterface<double>& interface, double cos_i,
                          FacetMasking masking) {
  const Microfacets<double>& facets = interface.facets;
  const Vec3 wi = {std::sqrt(1.0 - cos_i * cos_i), 0.0, cos_i};
  Fractions sum;
  detail::for_each_visible_facet(facets, wi, [&](const Vec3& h, double weight) {
    const double f = fresnel(std::clamp(dot(wi, h), 0.0, 1.0), interface.eta);
    if (const Vec3 wo = reflect(wi, h); wo.z > 0.0)
      sum.reflectance += weight * f *
                         (masking == FacetMasking::smith ? masking_shadowing(facets, wi, wo)
                                                         : v_cavity_masking(wi, wo, h));
    if (const auto wo = refract(wi, h, interface.eta); wo && wo->z < 0.0)
      sum.transmittance += weight * (1.0 - f) * masking_shadowing_through(facets, wi, *wo);
  });
  const double seen = projected_facet_area(facets, wi) / cos_i;  // 1 / masking(wi)
  const double reflected = sum.reflectance * seen;
  return {reflected, masking == FacetMasking::smith ? sum.transmittance * seen : 1.0 - reflected};
}

double cosine_mean(const std::vector<double>& values) {
  const int n = static_cast<int>(values.size()) - 1;
  double sum = 0.0;
  for (int i = 0; i <= n; ++i) {
    const double simpson = i == 0 || i == n ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    sum += simpson * 2.0 * i / n * values[static_cast<std::size_t>(i)];
  }
  return sum / (3.0 * n);
}

double interpolate(const std::vector<double>& values, double cos_i) {
  const double x = std::clamp(cos_i, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(x), values.size() - 2);
  const double t = x - static_cast<double>(i);
  return (1.0 - t) * values[i] + t * values[i + 1];
}

}  // namespace

InterfaceReflectance make_interface_reflectance(const RoughInterface<double>& interface,
                                                FacetMasking masking) {
  const bool is_smooth = is_specular(interface);
  InterfaceReflectance table;
  for (int i = 0; i < cosines; ++i) {
    const double cos_i = static_cast<double>(i) / (cosines - 1);
    const Fractions f = is_smooth ? smooth_fractions(cos_i, interface.eta)
                                  : rough_fractions(interface, std::max(cos_i, 1e-6), masking);
    table.reflectance.push_back(f.reflectance);
    table.transmittance.push_back(f.transmittance);
  }
  table.diffuse_reflectance =
      is_smooth ? fresnel_diffuse(interface.eta) : cosine_mean(table.reflectance);
  table.diffuse_transmittance =
      is_smooth ? 1.0 - table.diffuse_reflectance : cosine_mean(table.transmittance);
  return table;
}

double reflectance(const InterfaceReflectance& table, double cos_i) {
  return interpolate(table.reflectance, cos_i);
}

double transmittance(const InterfaceReflectance& table, double cos_i) {
  return interpolate(table.transmittance, cos_i);
}

}  // namespace lamina
