// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/dipole_profile.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/diffusion/albedo_inversion.h"

namespace lamina {
namespace {

double thickness(const LayerStack& stack) {
  double sum = 0.0;
  for (const Layer& layer : stack.layers()) sum += layer.thickness;
  return sum;
}

/// Integral of 2 pi r R(r + d).
double flux_farther_by(const Dipole& dipole, double d) {
  const double scale = std::max(d, dipole.z_r);
  return integrate(
      [&](double log_r) {
        const double r = std::exp(log_r);
        return 2.0 * std::numbers::pi * r * r * reflectance_profile(dipole, r + d);
      },
      std::log(1e-6 * scale), std::log(1e8 * scale), 1e-8);
}

}  // namespace

Dipole single_layer_dipole(const LayerStack& stack, const DiffusionOptions& options) {
  (void)make_layered_diffusion(stack, options);  // refuses layers that do not scatter
  const bool is_single = stack.layers().size() == 1;
  return make_dipole(is_single ? stack.layers()[0].medium : equivalent_half_space(stack, options),
                     stack.ior_above(), options);
}

Profile make_dipole_profile(std::span<const LayerStack> stacks, const DiffusionOptions& options,
                            const RadialGrid& grid) {
  if (stacks.empty()) throw InvalidInput("bands: at least one is required, but there are 0");
  Profile profile = {.per = ProfilePer::entered_flux, .bands = stacks.size(), .r = radii(grid)};
  profile.reflectance_profile.resize(profile.r.size() * stacks.size());
  profile.transmittance_profile.resize(profile.r.size() * stacks.size(), 0.0);
  for (std::size_t b = 0; b < stacks.size(); ++b) {
    const Dipole dipole = single_layer_dipole(stacks[b], options);
    const double d = thickness(stacks[b]);
    const bool is_finite = d < std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < profile.r.size(); ++i) {
      profile.reflectance_profile[i * stacks.size() + b] =
          reflectance_profile(dipole, profile.r[i]);
      if (is_finite)
        profile.transmittance_profile[i * stacks.size() + b] =
            reflectance_profile(dipole, profile.r[i] + d);
    }
    profile.total_reflectance.push_back(total_reflectance(dipole));
    profile.total_transmittance.push_back(is_finite ? flux_farther_by(dipole, d) : 0.0);
  }
  return profile;
}

}  // namespace lamina
