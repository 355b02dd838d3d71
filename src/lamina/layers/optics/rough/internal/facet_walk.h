// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/random.h"
#include "lamina/layers/optics/rough/rough_interface.h"

namespace lamina::detail {

/// Light on its way between the facets of a rough interface, [Heitz2016].
///
/// Heights enter only through u, the share of facets that are lower, so that the walk is the same
/// for every law of heights. Light inside the second medium is described in a frame turned over:
/// there too +z leads out of the facets, u counts those that are nearer to its medium's inside, and
/// eta is the index ratio across. A surface turned over has the same statistics.
struct FacetWalk {
  Vec3 direction;          ///< of travel
  double u = 1.0;          ///< in (0, 1)
  double eta = 1.0;        ///< index beyond over index on the side of the light
  bool is_beyond = false;  ///< in the second medium: z of the outer world is -z here
};

/// z changes its sign when one looks from the other side.
[[nodiscard]] inline Vec3 turned_over(const Vec3& w) { return {w.x, w.y, -w.z}; }

/// Where the light goes next: true, and u at the facet, if it meets one; false if it leaves.
///
/// A ray that rises from u is blocked below u' with the probability 1 - (u / u')^Lambda, one that
/// falls below u' with 1 - (u' / u)^(1 + Lambda), so it always is: [Heitz2016].
///
/// @param lambda  Smith's Lambda of the upward direction of the ray, or a rival's.
[[nodiscard]] inline bool meets_facet(FacetWalk& walk, double lambda, Random& random) {
  constexpr double least = 1e-15;
  const double draw = 1.0 - random.uniform();  // in (0, 1]
  if (walk.direction.z > 0.0) {
    if (draw <= std::pow(walk.u, lambda)) return false;
    walk.u = std::min(walk.u * std::pow(draw, -1.0 / lambda), 1.0 - least);
  } else {
    walk.u = std::max(walk.u * std::pow(draw, 1.0 / (1.0 + lambda)), least);
  }
  return true;
}

/// The light meets a facet of normal h, which faces it, and is reflected or refracted.
inline void scatter(FacetWalk& walk, const Vec3& h, Random& random) {
  const Vec3 view = -walk.direction;
  const double reflectance = fresnel(std::clamp(dot(view, h), 0.0, 1.0), walk.eta);
  if (random.uniform() >= reflectance)
    if (const auto onward = refract(view, h, walk.eta)) {
      walk = {.direction = turned_over(*onward),
              .u = std::max(1.0 - walk.u, 1e-15),
              .eta = 1.0 / walk.eta,
              .is_beyond = !walk.is_beyond};
      return;
    }
  walk.direction = reflect(view, h);
}

/// The direction of the light in the frame of the outer world.
[[nodiscard]] inline Vec3 direction_outside(const FacetWalk& walk) {
  return walk.is_beyond ? turned_over(walk.direction) : walk.direction;
}

/// Lambda of the upward direction of a ray, which may fall.
[[nodiscard]] inline double smith_lambda_of_ray(const Microfacets<double>& facets,
                                                const Vec3& ray) {
  return smith_lambda(facets, Vec3{ray.x, ray.y, std::max(std::abs(ray.z), 1e-12)});
}

/// Flux, per solid angle, from the facet that the light has come to straight to wo in the outer
/// world: reflected or refracted there, then met by no other facet.
[[nodiscard]] inline double flux_from_facet(const Microfacets<double>& facets,
                                            const FacetWalk& walk, const Vec3& wo) {
  const bool leaves_beyond = wo.z < 0.0;
  const Vec3 to = walk.is_beyond ? turned_over(wo) : wo;
  const double seen = leaves_beyond == walk.is_beyond ? walk.u : 1.0 - walk.u;
  return pdf_rough_interface({facets, walk.eta}, -walk.direction, to) *
         std::pow(seen, smith_lambda_of_ray(facets, wo));
}

}  // namespace lamina::detail
