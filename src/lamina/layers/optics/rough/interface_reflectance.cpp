// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/interface_reflectance.h"

#include <tuple>

#include "lamina/base/core/lazy_values.h"
#include "lamina/base/core/parallel.h"
#include "lamina/layers/optics/rough/facet_lattice.h"
#include "lamina/layers/optics/rough/multiple_scattering.h"

namespace lamina {
namespace {

constexpr std::size_t cosines = 129;  // odd, for Simpson's rule

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
                         (masking == FacetMasking::v_cavity ? v_cavity_masking(wi, wo, h)
                                                            : masking_shadowing(facets, wi, wo));
    if (const auto wo = refract(wi, h, interface.eta); wo && wo->z < 0.0)
      sum.transmittance += weight * (1.0 - f) * masking_shadowing_through(facets, wi, *wo);
  });
  const double seen = projected_facet_area(facets, wi) / cos_i;  // 1 / masking(wi)
  const double reflected = sum.reflectance * seen;
  return {reflected,
          masking == FacetMasking::v_cavity ? 1.0 - reflected : sum.transmittance * seen};
}

/// Of the light that meets several facets, the share that is reflected in the end.
double reflected_share_of_higher_orders(const RoughInterface<double>& interface, double cos_i) {
  const Vec3 wi = {std::sqrt(1.0 - cos_i * cos_i), 0.0, cos_i};
  Random random = make_random(0, 0);  // the same for all angles: smooth tables
  int found = 0, reflected = 0;
  for (int walk = 0; walk < 30'000 && found < 2'000; ++walk) {
    const MultipleScatteringSample sample = sample_multiple_scattering(interface, wi, random);
    if (sample.order < 2) continue;
    ++found;
    if (sample.wo.z > 0.0) ++reflected;
  }
  return (reflected + 0.5) / (found + 1.0);
}

/// Adds the light that meets several facets, so that nothing is lost.
void add_higher_orders(const RoughInterface<double>& interface, InterfaceReflectance& table) {
  constexpr std::size_t stride = 8;  // the share varies slowly
  static_assert((cosines - 1) % stride == 0);
  std::vector<double> shares((cosines - 1) / stride + 1);
  parallel_for(shares.size(), [&](std::size_t k) {
    shares[k] = reflected_share_of_higher_orders(
        interface, std::max(static_cast<double>(k * stride) / (cosines - 1), 1e-3));
  });
  for (std::size_t i = 0; i < cosines; ++i) {
    const std::size_t k = std::min(i / stride, shares.size() - 2);
    const double t = static_cast<double>(i - k * stride) / stride;
    const double lost = 1.0 - table.reflectance[i] - table.transmittance[i];
    table.reflectance[i] += lost * ((1.0 - t) * shares[k] + t * shares[k + 1]);
    table.transmittance[i] = 1.0 - table.reflectance[i];
  }
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

InterfaceReflectance integrated_reflectance(const RoughInterface<double>& interface,
                                            FacetMasking masking) {
  const bool is_smooth = is_specular(interface);
  InterfaceReflectance table;
  table.reflectance.resize(cosines);
  table.transmittance.resize(cosines);
  parallel_for(cosines, [&](std::size_t i) {
    const double cos_i = static_cast<double>(i) / (cosines - 1);
    const Fractions f = is_smooth ? smooth_fractions(cos_i, interface.eta)
                                  : rough_fractions(interface, std::max(cos_i, 1e-6), masking);
    table.reflectance[i] = f.reflectance;
    table.transmittance[i] = f.transmittance;
  });
  if (masking == FacetMasking::smith_multiple && !is_smooth) add_higher_orders(interface, table);
  table.diffuse_reflectance =
      is_smooth ? fresnel_diffuse(interface.eta) : cosine_mean(table.reflectance);
  table.diffuse_transmittance =
      is_smooth ? 1.0 - table.diffuse_reflectance : cosine_mean(table.transmittance);
  return table;
}

}  // namespace

InterfaceReflectance make_interface_reflectance(const RoughInterface<double>& interface,
                                                FacetMasking masking) {
  using Key = std::tuple<double, MicrofacetDistribution, double, FacetMasking>;
  static KeptValues<Key, InterfaceReflectance> kept(64);
  return kept.at({interface.facets.alpha, interface.facets.distribution, interface.eta, masking},
                 [&] { return integrated_reflectance(interface, masking); });
}

double reflectance(const InterfaceReflectance& table, double cos_i) {
  return interpolate(table.reflectance, cos_i);
}

double transmittance(const InterfaceReflectance& table, double cos_i) {
  return interpolate(table.transmittance, cos_i);
}

}  // namespace lamina
