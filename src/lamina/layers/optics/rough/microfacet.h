// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "lamina/base/core/vec.h"
#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

/// A rough surface as many small mirrors (facets) whose slopes follow a statistical law, the same
/// in all directions. Local frame: the mean normal is +z. For rays in float, for physics in double.
template <class T>
struct Microfacets {
  T alpha = T(0.1);  ///< roughness, in (0, 1] and beyond; RMS slope sqrt(2) times Beckmann's sigma
  MicrofacetDistribution distribution = MicrofacetDistribution::beckmann;
};

/// Density D of facet normals [1/sr]: facet area per solid angle of normals and unit area of the
/// mean plane. The integral of D(n) n.z over the upper hemisphere is 1; zero below.
///
/// Source: [Walter2007] Eqs. 25 (Beckmann) and 33 (GGX).
template <class T>
[[nodiscard]] T normal_density(const Microfacets<T>& facets, const BasicVec3<T>& n) {
  if (!(n.z > T{0})) return T{0};
  const T a2 = facets.alpha * facets.alpha;
  const T cos2 = n.z * n.z, sin2 = n.x * n.x + n.y * n.y;
  constexpr T inv_pi = std::numbers::inv_pi_v<T>;
  if (facets.distribution == MicrofacetDistribution::ggx) {
    const T root = cos2 + sin2 / a2;
    return inv_pi / (a2 * root * root);
  }
  return inv_pi * std::exp(-sin2 / (cos2 * a2)) / (a2 * cos2 * cos2);
}

/// Area of the facets that face `w`, projected towards w and per unit area of the mean plane:
/// the integral of D(n) max(0, dot(w, n)). For a direction below the mean plane it is what a ray
/// rising towards the surface from inside the hollows would meet.
///
/// Source: [Heitz2014], cos(theta) (1 + Lambda); the same formulas hold for w.z < 0.
template <class T>
[[nodiscard]] T projected_facet_area(const Microfacets<T>& facets, const BasicVec3<T>& w) {
  const T sin2 = w.x * w.x + w.y * w.y;
  const T tilt = facets.alpha * std::sqrt(sin2);
  if (facets.distribution == MicrofacetDistribution::ggx) {
    const T root = std::sqrt(w.z * w.z + tilt * tilt);
    return w.z > T{0} ? T{0.5} * (root + w.z) : T{0.5} * tilt * tilt / (root - w.z);
  }
  if (tilt == T{0}) return std::max(w.z, T{0});
  const T a = w.z / tilt;
  constexpr T inv_sqrtpi = std::numbers::inv_sqrtpi_v<T>;
  return std::max(T{0}, T{0.5} * (w.z * std::erfc(-a) + tilt * inv_sqrtpi * std::exp(-a * a)));
}

/// Smith's Lambda of a direction with 0 < w.z <= 1: facets hidden per facet seen.
///
/// Source: [Heitz2014] §5.3, Eq. 72 for GGX.
template <class T>
[[nodiscard]] T smith_lambda(const Microfacets<T>& facets, const BasicVec3<T>& w) {
  assert(w.z > T{0});
  const T sin2 = w.x * w.x + w.y * w.y;
  const T slope = facets.alpha * std::sqrt(sin2) / w.z;
  if (facets.distribution == MicrofacetDistribution::ggx) {
    const T s2 = slope * slope;
    return T{0.5} * s2 / (std::sqrt(T{1} + s2) + T{1});
  }
  if (slope < T(0.1)) return T{0};  // below 1e-45
  const T a = T{1} / slope;
  constexpr T inv_sqrtpi = std::numbers::inv_sqrtpi_v<T>;
  return std::max(T{0}, T{0.5} * (slope * inv_sqrtpi * std::exp(-a * a) - std::erfc(a)));
}

/// Fraction of the facets turned to `w` that is seen from there; 0 < w.z. Smith's G1.
template <class T>
[[nodiscard]] T masking(const Microfacets<T>& facets, const BasicVec3<T>& w) {
  return T{1} / (T{1} + smith_lambda(facets, w));
}

/// Fraction of the facets that is seen from both directions above the surface; high facets are more
/// likely seen from each. Source: [Heitz2014] Eq. 99.
template <class T>
[[nodiscard]] T masking_shadowing(const Microfacets<T>& facets, const BasicVec3<T>& wi,
                                  const BasicVec3<T>& wo) {
  return T{1} / (T{1} + smith_lambda(facets, wi) + smith_lambda(facets, wo));
}

/// Fraction of the facets that is seen from wi above and from wo below the surface, 0 < wi.z and
/// wo.z < 0. High facets are more likely seen from above and less from below: Euler's beta function
/// of 1 + Lambda_i and 1 + Lambda_o. Source: [Heitz2016].
template <class T>
[[nodiscard]] T masking_shadowing_through(const Microfacets<T>& facets, const BasicVec3<T>& wi,
                                          const BasicVec3<T>& wo);

/// The V-shaped grooves of Torrance and Sparrow: the fraction of a facet of normal h that is both
/// lit from wi and seen from wo, both above. For the papers that use it; Smith's is nearer to
/// nature.
///
/// Source: [TorranceSparrow1967], as given by [CookTorrance1982].
template <class T>
[[nodiscard]] T v_cavity_masking(const BasicVec3<T>& wi, const BasicVec3<T>& wo,
                                 const BasicVec3<T>& h) {
  const T wi_h = dot(wi, h), wo_h = dot(wo, h);
  if (!(wi_h > T{0} && wo_h > T{0})) return T{0};
  return std::min({T{1}, T{2} * h.z * wo.z / wo_h, T{2} * h.z * wi.z / wi_h});
}

/// Normal of a facet as seen from `w`: drawn with the density pdf_visible_normal.
///
/// @param w       unit vector, away from the surface; it may lie below the mean plane.
/// @param u1, u2  uniform in [0, 1).
///
/// Source: GGX [DupuyBenyoub2023]; Beckmann [HeitzDeon2014], whose inversion is solved to 1e-12
/// (float: 1e-6) by Halley steps in the variable of [Jakob2014].
template <class T>
[[nodiscard]] BasicVec3<T> sample_visible_normal(const Microfacets<T>& facets,
                                                 const BasicVec3<T>& w, T u1, T u2);

/// Density of visible normals [1/sr]. Source: [Heitz2014].
template <class T>
[[nodiscard]] T pdf_visible_normal(const Microfacets<T>& facets, const BasicVec3<T>& w,
                                   const BasicVec3<T>& n) {
  const T facing = dot(w, n);
  if (!(facing > T{0})) return T{0};
  const T area = projected_facet_area(facets, w);
  return area > T{0} ? normal_density(facets, n) * facing / area : T{0};
}

}  // namespace lamina
