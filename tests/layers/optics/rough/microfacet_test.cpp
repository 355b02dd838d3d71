// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/microfacet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/base/core/quadrature.h"
#include "lamina/base/core/random.h"
#include "layers/optics/rough/sampler_test.h"

namespace lamina {
namespace {

constexpr std::array distributions = {MicrofacetDistribution::beckmann,
                                      MicrofacetDistribution::ggx};
constexpr double degree = std::numbers::pi / 180.0;

Vec3 direction(double theta, double phi = 0.0) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// Integral of f over normals of the upper hemisphere, in slopes scaled by the roughness.
template <class F>
double integrate_normals(const F& f, double alpha) {
  const auto over_radius = [&](double q) {  // slope alpha * r, r = q / (1 - q)
    const double r = q / (1.0 - q), theta = std::atan(alpha * r), c = std::cos(theta);
    const auto over_phi = [&](double phi) { return f(direction(theta, phi)); };
    // The density over slopes is that over solid angle times cos^3.
    return 2.0 * integrate(over_phi, 0.0, std::numbers::pi, 1e-9) * c * c * c * alpha * alpha * r /
           ((1.0 - q) * (1.0 - q));
  };
  return integrate(over_radius, 0.0, 1.0 - 1e-9, 1e-9);
}

TEST(Microfacets, CoverTheMeanPlaneExactlyOnce) {
  for (const auto distribution : distributions)
    for (const double alpha : {0.01, 0.1, 0.5, 1.0}) {
      const Microfacets<double> facets{alpha, distribution};
      const auto projected = [&](const Vec3& n) { return normal_density(facets, n) * n.z; };
      EXPECT_NEAR(integrate_normals(projected, alpha), 1.0, 1e-7) << alpha;
    }
}

TEST(Microfacets, ProjectedAreaIsTheIntegralOverTheFacetsThatFaceTheView) {
  for (const auto distribution : distributions)
    for (const double alpha : {0.1, 0.5, 1.0})
      for (const double theta : {0.0, 45.0, 80.0, 90.0, 110.0, 140.0}) {
        const Microfacets<double> facets{alpha, distribution};
        const Vec3 w = direction(theta * degree);
        const auto facing = [&](const Vec3& n) {
          return normal_density(facets, n) * std::max(0.0, dot(w, n));
        };
        EXPECT_NEAR(projected_facet_area(facets, w), integrate_normals(facing, alpha), 2e-7)
            << alpha << " at " << theta;
      }
}

// What is seen fills the view: G1 times the area that faces it is the cosine: [Heitz2014].
TEST(Microfacets, MaskingLeavesTheAreaOfTheMeanPlane) {
  for (const auto distribution : distributions)
    for (const double alpha : {0.01, 0.3, 1.0})
      for (const double theta : {0.0, 30.0, 60.0, 85.0, 89.9}) {
        const Microfacets<double> facets{alpha, distribution};
        const Vec3 w = direction(theta * degree);
        EXPECT_NEAR(masking(facets, w) * projected_facet_area(facets, w), w.z, 1e-14);
      }
}

// Both are averages over facet heights h, uniform in u = the share of facets that are lower, of the
// visibility u^Lambda upwards and (1 - u)^Lambda downwards: Smith's model.
TEST(Microfacets, MaskingAndShadowingAverageOverHeights) {
  for (const auto distribution : distributions)
    for (const double alpha : {0.5, 1.0})
      for (const double theta : {40.0, 80.0}) {
        const Microfacets<double> facets{alpha, distribution};
        const Vec3 wi = direction(70.0 * degree), wo = direction(theta * degree);
        const double li = smith_lambda(facets, wi), lo = smith_lambda(facets, wo);
        const auto up = [&](double u) { return std::pow(u, li) * std::pow(u, lo); };
        const auto down = [&](double u) { return std::pow(u, li) * std::pow(1.0 - u, lo); };
        EXPECT_NEAR(masking_shadowing(facets, wi, wo), integrate(up, 0.0, 1.0, 1e-9), 1e-8);
        EXPECT_NEAR(masking_shadowing_through(facets, wi, -wo), integrate(down, 0.0, 1.0, 1e-9),
                    1e-8);
      }
}

TEST(Microfacets, GroovesShowHalfAFacetAtGrazingAndAllOfItFromAbove) {
  const Vec3 z = {0.0, 0.0, 1.0};
  EXPECT_EQ(v_cavity_masking(z, z, z), 1.0);
  const Vec3 wi = direction(80.0 * degree), wo = direction(70.0 * degree);
  const Vec3 h = normalize(wi + wo);
  EXPECT_NEAR(v_cavity_masking(wi, wo, h), 2.0 * h.z * wi.z / dot(wi, h), 1e-15);
  EXPECT_EQ(v_cavity_masking(wi, wo, h), v_cavity_masking(wo, wi, h));
  EXPECT_EQ(v_cavity_masking(wi, wo, direction(100.0 * degree, 3.0)), 0.0);
}

TEST(VisibleNormals, FollowTheirDensity) {
  for (const auto distribution : distributions)
    for (const double alpha : {0.01, 0.1, 0.4, 1.0})
      for (const double theta : {0.0, 45.0, 80.0, 89.5, 100.0, 150.0}) {
        // From below, facets of small slope are out of sight; no ray can come to see others.
        if (theta > 90.0 && alpha * std::abs(std::tan(theta * degree)) < 0.3) continue;
        const Microfacets<double> facets{alpha, distribution};
        const Vec3 w = direction(theta * degree, 0.7);
        Random random = make_random(11, static_cast<std::uint64_t>(theta * 100.0 * alpha));
        const double z = chi_square_deviation(
            [&]() -> std::optional<Vec3> {
              return sample_visible_normal(facets, w, random.uniform(), random.uniform());
            },
            [&](const Vec3& n) { return pdf_visible_normal(facets, w, n); }, 40'000);
        EXPECT_LT(std::abs(z), 4.5) << alpha << " at " << theta;
      }
}

TEST(VisibleNormals, FollowTheirDensityInSinglePrecision) {
  for (const auto distribution : distributions)
    for (const double alpha : {0.05, 0.7})
      for (const double theta : {0.0, 60.0, 89.0}) {
        const Microfacets<double> facets{alpha, distribution};
        const Vec3 w = direction(theta * degree, 0.7);
        const Vec3f wf = {static_cast<float>(w.x), static_cast<float>(w.y),
                          static_cast<float>(w.z)};
        Random random = make_random(12, static_cast<std::uint64_t>(theta * 100.0 * alpha));
        const double z = chi_square_deviation(
            [&]() -> std::optional<Vec3> {
              const Vec3f n = sample_visible_normal({static_cast<float>(alpha), distribution}, wf,
                                                    random.uniform_float(), random.uniform_float());
              return Vec3{n.x, n.y, n.z};
            },
            [&](const Vec3& n) { return pdf_visible_normal(facets, w, n); }, 40'000);
        EXPECT_LT(std::abs(z), 4.5) << alpha << " at " << theta;
      }
}

TEST(VisibleNormals, AreUnitVectorsThatFaceTheViewAtTheEdgesOfTheUnitSquare) {
  for (const auto distribution : distributions)
    for (const float alpha : {1e-4f, 0.01f, 1.0f})
      for (const double theta : {0.0, 1e-4, 60.0, 90.0 - 1e-4})
        for (const float u1 : {0.0f, 0.5f, 0x1.fffffep-1f})
          for (const float u2 : {0.0f, 0.5f, 0x1.fffffep-1f}) {
            const Vec3 w = direction(theta * degree);
            const Vec3f wf = {static_cast<float>(w.x), static_cast<float>(w.y),
                              static_cast<float>(w.z)};
            const Vec3f n = sample_visible_normal<float>({alpha, distribution}, wf, u1, u2);
            EXPECT_NEAR(length(n), 1.0f, 1e-5f);
            EXPECT_GT(n.z, 0.0f);
            EXPECT_GE(dot(wf, n), -0.01f) << alpha << " " << theta << " " << u1 << " " << u2;
          }
}

}  // namespace
}  // namespace lamina
