// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "lamina/base/core/estimate.h"
#include "lamina/layers/optics/rough/internal/facet_walk.h"

namespace lamina {

/// All the light that evaluate_multiple_scattering sends into the sphere for a unit flux from wi.
struct FacetFurnace {
  double single;    ///< order 1, by quadrature over facets
  Estimate higher;  ///< the integral of what evaluation adds for the other orders
  [[nodiscard]] double total() const { return single + higher.value; }
};

/// Directions are drawn afresh at each facet of a walk, from its own lobe, so the integrand is a
/// probability; directions drawn without regard to the facet would need a hundred times the walks.
inline FacetFurnace facet_furnace(const RoughInterface<double>& interface, const Vec3& wi,
                                  int walks, Random& random) {
  const Microfacets<double>& facets = interface.facets;
  const auto sample_normal = [&](const Vec3& from, double u1, double u2) {
    return sample_visible_normal(facets, from, u1, u2);
  };
  constexpr int lattice = 200;
  double single = 0.0;
  for (int i = 0; i < lattice; ++i)
    for (int j = 0; j < lattice; ++j) {
      const double u1 = (i + 0.5) / lattice, u2 = (j + 0.5) / lattice;
      const double r =
          fresnel(std::clamp(dot(wi, sample_normal(wi, u1, u2)), 0.0, 1.0), interface.eta);
      single += r * sample_rough_interface(interface, wi, u1, u2, 0.0).weight;
      if (r < 1.0)
        single += (1.0 - r) * sample_rough_interface(interface, wi, u1, u2, 0.5 * (1.0 + r)).weight;
    }
  single /= lattice * lattice;

  double sum = 0.0, sum2 = 0.0;
  for (int i = 0; i < walks; ++i) {
    detail::FacetWalk walk{.direction = -wi, .eta = interface.eta};
    double flux = 0.0;
    for (int order = 0; order < 10'000; ++order) {
      const double lambda = detail::smith_lambda_of_ray(facets, walk.direction);
      if (!meets_facet(walk, lambda, random)) break;
      const Vec3 from = -walk.direction;
      if (order > 0) {
        detail::FacetWalk onward = walk;
        scatter(onward, sample_normal(from, random.uniform(), random.uniform()), random);
        if (onward.direction.z > 0.0) {
          const Vec3 wo = detail::direction_outside(onward);
          const Vec3 to = walk.is_beyond ? detail::turned_over(wo) : wo;
          const double pdf = pdf_rough_interface({facets, walk.eta}, from, to);
          if (pdf > 0.0) flux += detail::flux_from_facet(facets, walk, wo) / pdf;
        }
      }
      scatter(walk, sample_normal(from, random.uniform(), random.uniform()), random);
    }
    sum += flux, sum2 += flux * flux;
  }
  const double mean = sum / walks;
  return {.single = single,
          .higher = {.value = mean,
                     .standard_error =
                         std::sqrt(std::max(0.0, sum2 / walks - mean * mean) / (walks - 1))}};
}

}  // namespace lamina
