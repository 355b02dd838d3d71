// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/pulsed_dipole.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/layers/optics/speed_of_light.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"

namespace lamina {

EscapeWeights make_escape_weights(const Interface& boundary, double ior_inside,
                                  double ior_outside) {
  const double f =
      diffuse_reflectance_inside(boundary, ior_inside, ior_outside, DiffuseFresnel::exact);
  if (boundary.roughness > 0.0) return {0.25 * (1.0 - f), 0.5 * (1.0 - f)};
  // Over the cosines that are not reflected as a whole; mu^2 = low + (1 - low) u^2 makes Fresnel's
  // law smooth at their end.
  const double eta = ior_outside / ior_inside;
  const double low = std::max(0.0, 1.0 - eta * eta);
  const Quadrature rule = gauss_legendre(32, 0.0, 1.0);
  double square = 0.0;
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    const double u = rule.nodes[i], mu = std::min(1.0, std::sqrt(low + (1.0 - low) * u * u));
    square += rule.weights[i] * (1.0 - low) * u * mu * (1.0 - fresnel(mu, eta));
  }
  return {0.25 * (1.0 - f), 1.5 * square};
}

PulsedDipole make_pulsed_dipole(const Layer& layer, double ior_outside) {
  assert(sigma_s_prime(layer.medium) > 0.0);
  const EscapeWeights escape = make_escape_weights(layer.top, layer.medium.ior, ior_outside);
  const double z = 1.0 / sigma_s_prime(layer.medium), D = z / 3.0;
  return {.source_depth = z,
          .image_height = z + 4.0 * escape.fluence_ratio() * D,
          .D = D,
          .speed = speed_of_light / layer.medium.ior,
          .sigma_a = layer.medium.sigma_a,
          .escape = escape};
}

double pulsed_reflectance(const PulsedDipole& dipole, double r, double t) {
  if (!(t > 0.0)) return 0.0;
  const double spread = 4.0 * dipole.D * dipole.speed * t;  // [mm²]
  const auto cloud = [&](double z) { return std::exp(-(r * r + z * z) / spread); };
  const double source = cloud(dipole.source_depth), image = cloud(dipole.image_height);
  const double common =
      std::exp(-dipole.sigma_a * dipole.speed * t) / std::pow(std::numbers::pi * spread, 1.5);
  const double fluence = dipole.speed * common * (source - image);
  const double flux =
      common * (dipole.source_depth * source + dipole.image_height * image) / (2.0 * t);
  return dipole.escape.fluence * fluence + dipole.escape.flux * flux;
}

}  // namespace lamina
