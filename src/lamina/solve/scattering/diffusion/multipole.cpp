// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/multipole.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"

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

/// The light of a point source at depth z, seen from the side whose extrapolation distance is
/// z_near. The exponents left over from the decaying forms are those of the paths from the source
/// to the two boundaries.
OneWay point_source(const Multipole& layer, double s, double z, double z_near, double z_far) {
  const double d = layer.thickness, L = d + z_near + z_far;
  return {layer.albedo_prime * std::exp(-s * z) * decaying_cosh(s, z_near) *
              decaying_sinh_ratio(s, d - z + z_far, L),
          layer.albedo_prime * std::exp(-s * (d - z)) * decaying_cosh(s, z_far) *
              decaying_sinh_ratio(s, z + z_near, L)};
}

/// What becomes of the light that enters a layer before it scatters.
struct Straight {
  double scattered;  ///< fraction that scatters on its way across
  double turned;     ///< part of the whole that the far boundary turns back
};

Straight straight_light(const Multipole& layer, double z_near, double z_far) {
  if (!is_thin(layer)) return {1.0, 0.0};
  const auto turned_back_by = [&](double z_b) {  // of diffuse light: z_b = 2 A l / 3, solved for f
    const double A = 1.5 * z_b / layer.source_depth;
    return (A - 1.0) / (A + 1.0);
  };
  const double near = turned_back_by(z_near), far = turned_back_by(z_far);
  const double scattered = layer.thickness / layer.source_depth;
  return {scattered, (1.0 - scattered) * std::max(0.0, (far - near) / (1.0 - near))};
}

/// Light enters at the side whose extrapolation distance is z_near.
OneWay one_way(const Multipole& layer, double s, double z_near, double z_far) {
  const double z = std::min(layer.source_depth, layer.thickness);
  const auto [scattered, turned] = straight_light(layer, z_near, z_far);
  const OneWay across = point_source(layer, s, z, z_near, z_far);
  if (scattered == 1.0) return across;
  const double left = 1.0 - scattered;
  const OneWay back = point_source(layer, s, 0.0, z_near, z_far);  // it has come to the near side
  return {scattered * across.reflection + turned * (scattered * back.reflection + left),
          scattered * across.transmission + turned * scattered * back.transmission + left - turned};
}

/// The limit of `one_way` for s to infinity: half of what a source at a boundary gives off.
OneWay one_way_locally(const Multipole& layer, double z_near, double z_far) {
  if (!is_thin(layer)) return {0.0, 0.0};
  const auto [scattered, turned] = straight_light(layer, z_near, z_far);
  const double source = 0.5 * layer.albedo_prime * scattered, left = 1.0 - scattered;
  return {turned * (source + left), source + left - turned};
}

/// @param of  light one way, from the extrapolation distances of the near and the far side
template <class OneWayOf>
LayerResponse both_ways(const Multipole& layer, const OneWayOf& of) {
  const OneWay above = of(layer.z_b_top, layer.z_b_bottom);
  const OneWay below = of(layer.z_b_bottom, layer.z_b_top);
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
  return both_ways(layer, [&](double near, double far) { return one_way(layer, s, near, far); });
}

LayerResponse local_response(const Multipole& layer) {
  return both_ways(layer,
                   [&](double near, double far) { return one_way_locally(layer, near, far); });
}

}  // namespace lamina
