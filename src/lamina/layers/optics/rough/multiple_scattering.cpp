// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/multiple_scattering.h"

#include "lamina/layers/optics/rough/internal/facet_walk.h"

namespace lamina {
namespace {

using detail::FacetWalk;

constexpr int most_facets = 10'000;  // a walk leaves after a handful

/// Takes the light to the next facet and gives its normal; false if it leaves.
bool advance(FacetWalk& walk, const Microfacets<double>& facets, Random& random, Vec3& normal) {
  const double lambda = detail::smith_lambda_of_ray(facets, walk.direction);
  if (!meets_facet(walk, lambda, random)) return false;
  const double u1 = random.uniform(), u2 = random.uniform();
  normal = sample_visible_normal(facets, -walk.direction, u1, u2);
  return true;
}

}  // namespace

MultipleScatteringSample sample_multiple_scattering(const RoughInterface<double>& interface,
                                                    const Vec3& wi, Random& random) {
  assert(wi.z > 0.0);
  if (is_specular(interface))
    return {.wo = sample_rough_interface(interface, wi, 0.5, 0.5, random.uniform()).wo, .order = 1};
  FacetWalk walk = {.direction = -wi, .eta = interface.eta};
  Vec3 normal;
  for (int order = 0; order < most_facets; ++order) {
    if (!advance(walk, interface.facets, random, normal))
      return {.wo = detail::direction_outside(walk), .order = order};
    scatter(walk, normal, random);
  }
  return {.wo = wi, .order = 0};
}

double evaluate_multiple_scattering(const RoughInterface<double>& interface, const Vec3& wi,
                                    const Vec3& wo, Random& random) {
  assert(wi.z > 0.0);
  if (is_specular(interface) || wo.z == 0.0) return 0.0;
  const Microfacets<double>& facets = interface.facets;
  FacetWalk walk = {.direction = -wi, .eta = interface.eta};
  Vec3 normal;
  double flux = 0.0;  // to wo, per solid angle
  for (int order = 0; order < most_facets; ++order) {
    if (!advance(walk, facets, random, normal)) break;
    if (order > 0) flux += flux_from_facet(facets, walk, wo);
    scatter(walk, normal, random);
  }
  return bsdf(interface, wi, wo) + flux / std::abs(wo.z);
}

double approximate_pdf_multiple_scattering(const RoughInterface<double>& interface, const Vec3& wi,
                                           const Vec3& wo, double single_scattered) {
  constexpr double inv_2pi = 0.5 * std::numbers::inv_pi;
  return pdf_rough_interface(interface, wi, wo) +
         std::max(0.0, 1.0 - single_scattered) * std::abs(wo.z) * inv_2pi;
}

}  // namespace lamina
