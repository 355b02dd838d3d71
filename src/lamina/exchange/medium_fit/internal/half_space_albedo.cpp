// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/medium_fit/internal/half_space_albedo.h"

#include <cmath>
#include <utility>

#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {

HalfSpaceAlbedo half_space_albedo(double reflectance, double g, double ior, double ior_above) {
  // The reflectance falls nearly along a straight line in u = sqrt(1 - albedo').
  const auto reflectance_at = [&](double u) {
    const LayerStack stack(
        {{.medium = {.sigma_a = u * u, .sigma_s = (1.0 - u * u) / (1.0 - g), .g = g, .ior = ior}}},
        ior_above, ior);
    return adding_doubling(stack, {.is_diffuse = true}, {.accuracy = 1e-6})
        .totals.diffuse_reflectance;
  };
  constexpr double enough = 2e-6;
  double low = 1e-4, high = 0.9999;  // half-spaces that absorb less than a 1e-8th never end
  double at_low = reflectance_at(low), at_high = reflectance_at(high);
  const auto result = [&](double u, double found) {
    return HalfSpaceAlbedo{.albedo_prime = 1.0 - u * u,
                           .reflectance = found,
                           .is_met = std::abs(found - reflectance) < 1e-5};
  };
  if (reflectance >= at_low) return result(low, at_low);
  if (reflectance <= at_high) return result(high, at_high);
  // False position, with the end that stays halved: the Illinois rule.
  double weight_low = 1.0, weight_high = 1.0, u = low, found = at_low;
  for (int i = 0; i < 60 && std::abs(found - reflectance) > enough; ++i) {
    const double above = weight_low * (at_low - reflectance);
    const double below = weight_high * (reflectance - at_high);
    u = (low * below + high * above) / (above + below);
    found = reflectance_at(u);
    if (found > reflectance) {
      low = u;
      at_low = found;
      weight_low = 1.0;
      weight_high *= 0.5;
    } else {
      high = u;
      at_high = found;
      weight_high = 1.0;
      weight_low *= 0.5;
    }
  }
  return result(u, found);
}

}  // namespace lamina
