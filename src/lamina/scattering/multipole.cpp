// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/multipole.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "lamina/core/quadrature.h"
#include "lamina/scattering/diffuse_boundary.h"

namespace lamina {
namespace {

/// (1 - exp(-2 s b)) / (1 - exp(-2 s L)) for 0 <= b <= L: sinh(s b) / sinh(s L) without its growth.
double decaying_sinh_ratio(double s, double b, double L) {
  const double below = std::expm1(-2.0 * s * L);
  return below == 0.0 ? b / L : std::expm1(-2.0 * s * b) / below;
}

/// cosh(s z) without its growth.
double decaying_cosh(double s, double z) { return 0.5 * (1.0 + std::exp(-2.0 * s * z)); }

struct OneWay {
  double reflection, transmission;
};

/// Light enters at the side whose extrapolation distance is z_near. The exponents left over from
/// the decaying forms are those of the paths from the source to the two boundaries.
OneWay point_source(const Multipole& layer, double s, double z_near, double z_far) {
  const double l = layer.source_depth, d = layer.thickness, L = d + z_near + z_far;
  return {layer.albedo_prime * std::exp(-s * l) * decaying_cosh(s, z_near) *
              decaying_sinh_ratio(s, d - l + z_far, L),
          layer.albedo_prime * std::exp(-s * (d - l)) * decaying_cosh(s, z_far) *
              decaying_sinh_ratio(s, l + z_near, L)};
}

/// The point source averaged over its depth z with the density sigma exp(-sigma z).
OneWay extended_source(const Multipole& layer, double s, double z_near, double z_far) {
  const double sigma = 1.0 / layer.source_depth, d = layer.thickness, L = d + z_near + z_far;
  double up = 0.0, down = 0.0;
  if (s * d < 0.1) {  // here the closed form below cancels, and few nodes are enough
    static const Quadrature rule = gauss_legendre(20, 0.0, 1.0);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double z = d * rule.nodes[i];
      const double weight = d * rule.weights[i] * sigma * std::exp(-sigma * z);
      up += weight * std::exp(-s * z) * decaying_sinh_ratio(s, d - z + z_far, L);
      down += weight * std::exp(-s * (d - z)) * decaying_sinh_ratio(s, z + z_near, L);
    }
  } else {
    const double all = -std::expm1(-2.0 * s * L);
    const double direct = -std::expm1(-(sigma + s) * d) / (sigma + s);
    const double apart = std::abs(s - sigma) * d;  // 0 where source and light fade alike
    const double across =
        std::exp(-std::min(s, sigma) * d) * d * (apart > 0.0 ? -std::expm1(-apart) / apart : 1.0);
    up = sigma / all * (direct - std::exp(-s * (d + 2.0 * z_far)) * across);
    down = sigma / all * (across - std::exp(-s * (d + 2.0 * z_near)) * direct);
  }
  return {layer.albedo_prime * decaying_cosh(s, z_near) * up,
          layer.albedo_prime * decaying_cosh(s, z_far) * down + std::exp(-sigma * d)};
}

LayerResponse finite_response(const Multipole& layer, double s,
                              OneWay (*one_way)(const Multipole&, double, double, double)) {
  const OneWay above = one_way(layer, s, layer.z_b_top, layer.z_b_bottom);
  const OneWay below = one_way(layer, s, layer.z_b_bottom, layer.z_b_top);
  return {.reflection_above = above.reflection,
          .transmission_down = above.transmission,
          .reflection_below = below.reflection,
          .transmission_up = below.transmission};
}

}  // namespace

Multipole make_multipole(const Medium& medium, double thickness, double reflectance_top,
                         double reflectance_bottom) {
  assert(sigma_s_prime(medium) > 0.0 && thickness > 0.0);
  return {.source_depth = mfp_prime(medium),
          .sigma_tr = sigma_tr(medium),
          .albedo_prime = albedo_prime(medium),
          .thickness = thickness,
          .z_b_top = extrapolation_distance(medium, reflectance_top),
          .z_b_bottom = extrapolation_distance(medium, reflectance_bottom)};
}

LayerResponse response(const Multipole& layer, double k) {
  const double s = std::hypot(k, layer.sigma_tr);
  if (layer.thickness == std::numeric_limits<double>::infinity())
    return {.reflection_above = layer.albedo_prime * std::exp(-s * layer.source_depth) *
                                decaying_cosh(s, layer.z_b_top),
            .transmission_down = 0.0,
            .reflection_below = 0.0,
            .transmission_up = 0.0};
  return finite_response(layer, s,
                         is_thinner_than_source_depth(layer) ? extended_source : point_source);
}

LayerResponse spread_source_response(const Multipole& layer, double k) {
  if (layer.thickness == std::numeric_limits<double>::infinity()) return response(layer, k);
  return finite_response(layer, std::hypot(k, layer.sigma_tr), extended_source);
}

double unscattered_transmittance(const Multipole& layer) {
  return is_thinner_than_source_depth(layer) ? std::exp(-layer.thickness / layer.source_depth)
                                             : 0.0;
}

}  // namespace lamina
