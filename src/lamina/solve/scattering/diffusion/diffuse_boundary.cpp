// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "lamina/layers/optics/rough/interface_reflectance.h"

namespace lamina {
namespace {

InterfaceReflectance table_of(const Interface& boundary, double ior_before, double ior_beyond,
                              FacetMasking masking) {
  return make_interface_reflectance(make_rough_interface<double>(boundary, ior_before, ior_beyond),
                                    masking);
}

bool is_smooth(const Interface& boundary) { return boundary.roughness == 0.0; }

}  // namespace

double diffuse_reflectance_inside(const Interface& boundary, double ior_inside, double ior_outside,
                                  DiffuseFresnel fresnel) {
  const double eta = ior_outside / ior_inside;
  if (eta == 1.0) return 0.0;
  if (!is_smooth(boundary))
    return table_of(boundary, ior_inside, ior_outside,
                    fresnel == DiffuseFresnel::exact ? FacetMasking::smith_multiple
                                                     : FacetMasking::v_cavity)
        .diffuse_reflectance;
  // The polynomials leave [0, 1) far from the indices that they were fitted to.
  return fresnel == DiffuseFresnel::exact ? fresnel_diffuse(eta)
                                          : std::clamp(fresnel_diffuse_polynomial(eta), 0.0, 0.999);
}

double diffuse_reflectance_outside(const Interface& boundary, double ior_outside,
                                   double ior_inside) {
  const double eta = ior_inside / ior_outside;
  if (is_smooth(boundary)) return fresnel_diffuse(eta);
  return table_of(boundary, ior_outside, ior_inside, FacetMasking::smith_multiple)
      .diffuse_reflectance;
}

double fluence_ratio(double reflectance_inside) {
  assert(0.0 <= reflectance_inside && reflectance_inside < 1.0);
  return (1.0 + reflectance_inside) / (1.0 - reflectance_inside);
}

double extrapolation_distance(const Medium& medium, double reflectance_inside) {
  assert(sigma_s_prime(medium) > 0.0);
  const double D = mfp_prime(medium) / 3.0;
  return 2.0 * fluence_ratio(reflectance_inside) * D;
}

double entry_transmittance(const LayerStack& stack, const Incidence& incidence) {
  const Layer& first = stack.layers()[0];
  const double cos_i = std::clamp(std::cos(incidence.theta), 0.0, 1.0);
  if (is_smooth(first.top)) {
    const double eta = first.medium.ior / stack.ior_above();
    return 1.0 - (incidence.is_diffuse ? fresnel_diffuse(eta) : fresnel(cos_i, eta));
  }
  const InterfaceReflectance table =
      table_of(first.top, stack.ior_above(), first.medium.ior, FacetMasking::v_cavity);
  return incidence.is_diffuse ? table.diffuse_transmittance : transmittance(table, cos_i);
}

}  // namespace lamina
