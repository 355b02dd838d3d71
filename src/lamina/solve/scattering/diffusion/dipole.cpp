// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/dipole.h"

#include <cassert>
#include <cmath>
#include <numbers>

namespace lamina {

Dipole make_dipole(const Medium& medium, double ior_outside, const DiffusionOptions& options) {
  assert(sigma_s_prime(medium) > 0.0);
  const double f_dr = diffuse_reflectance_inside({}, medium.ior, ior_outside, options.fresnel);
  const double z_r = mfp_prime(medium);
  return {.z_r = z_r,
          .z_v = z_r + 2.0 * extrapolation_distance(medium, f_dr),
          .sigma_tr = sigma_tr(medium),
          .albedo_prime = albedo_prime(medium)};
}

double reflectance_profile(const Dipole& dipole, double r) {
  const auto flux_from = [&](double z) {
    const double d = std::hypot(r, z);
    const double x = dipole.sigma_tr * d;
    return z * (1.0 + x) * std::exp(-x) / (d * d * d);
  };
  return dipole.albedo_prime / (4.0 * std::numbers::pi) *
         (flux_from(dipole.z_r) + flux_from(dipole.z_v));
}

double reflectance_at_frequency(const Dipole& dipole, double k) {
  const double s = std::hypot(k, dipole.sigma_tr);
  return 0.5 * dipole.albedo_prime * (std::exp(-s * dipole.z_r) + std::exp(-s * dipole.z_v));
}

double total_reflectance(const Dipole& dipole) { return reflectance_at_frequency(dipole, 0.0); }

}  // namespace lamina
