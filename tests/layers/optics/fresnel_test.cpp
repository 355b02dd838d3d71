// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/fresnel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lamina/base/core/quadrature.h"

namespace lamina {
namespace {

TEST(Fresnel, LightRetracesItsPathWithTheSameReflectance) {
  for (const double eta : {1.01, 1.33, 1.5, 2.4})
    for (const double cos_i : {0.05, 0.3, 0.7, 1.0}) {
      const double cos_t = std::sqrt(1.0 - (1.0 - cos_i * cos_i) / (eta * eta));
      EXPECT_NEAR(fresnel(cos_t, 1.0 / eta), fresnel(cos_i, eta), 1e-14) << "eta " << eta;
    }
}

TEST(Fresnel, AtNormalIncidenceIsTheSquareOfTheIndexContrast) {
  EXPECT_NEAR(fresnel(1.0, 1.5), 0.04, 1e-15);
  EXPECT_NEAR(fresnel(1.0, 1.4), std::pow(0.4 / 2.4, 2), 1e-15);
}

TEST(Fresnel, ReflectsEverythingBeyondTheCriticalAngleAndAtGrazing) {
  EXPECT_EQ(fresnel(0.5, 1.0 / 1.5), 1.0);
  EXPECT_NEAR(fresnel(0.0, 1.5), 1.0, 1e-15);
  EXPECT_EQ(fresnel(0.3, 1.0), 0.0);
}

// The integral that defines it. mu = c + (1 - c) t^4 from the critical cosine c on takes away the
// square-root edge of total reflection.
double fresnel_diffuse_by_quadrature(double eta) {
  const double c = eta < 1.0 ? std::sqrt(1.0 - eta * eta) : 0.0;
  const auto integrand = [&](double t) {
    const double mu = std::min(1.0, c + (1.0 - c) * t * t * t * t);
    return 2.0 * mu * fresnel(mu, eta) * 4.0 * t * t * t * (1.0 - c);
  };
  return c * c + integrate(integrand, 0.0, 1.0, 1e-14);
}

TEST(FresnelDiffuse, IsTheCosineMeanOfTheReflectance) {
  for (const double eta :
       {1e-3,     0.1,  0.5,  1.0 / 1.4, 1.0 / 1.33, 0.9, 0.99, 0.999999, 1.0 - 1e-9, 1.0 + 1e-9,
        1.000001, 1.01, 1.13, 1.14,      1.33,       1.4, 1.5,  2.4,      10.0,       1e3})
    EXPECT_NEAR(fresnel_diffuse(eta), fresnel_diffuse_by_quadrature(eta), 1e-13) << "eta " << eta;
}

// [DonnerJensen2005] use .53 for light inside a medium of index 1.4; [Duntley1942] 0.092 at 1.5.
TEST(FresnelDiffuse, HasItsTextbookValuesAndVanishesForMatchedIndices) {
  EXPECT_NEAR(fresnel_diffuse(1.5), 0.0918, 5e-5);
  EXPECT_NEAR(fresnel_diffuse(1.0 / 1.5), 0.5963, 5e-5);
  EXPECT_NEAR(fresnel_diffuse(1.0 / 1.4), 0.53, 2e-3);
  EXPECT_EQ(fresnel_diffuse(1.0), 0.0);
}

TEST(FresnelDiffuse, PolynomialStaysWithinItsStatedError) {
  double worst = 0.0;
  for (double ior = 0.6; ior <= 2.0; ior += 0.001)
    worst = std::max(worst,
                     std::abs(fresnel_diffuse_polynomial(1.0 / ior) - fresnel_diffuse(1.0 / ior)));
  EXPECT_LT(worst, 0.00171);
  EXPECT_GT(worst, 0.0015);  // the statement is not idle either
}

TEST(Refraction, KeepsTheTangentialPartOfTheWaveVector) {
  const Vec3 n = normalize(Vec3{0.1, -0.2, 0.9});
  for (const double eta : {1.0 / 1.5, 1.0, 1.4}) {
    const Vec3 w = normalize(Vec3{0.3, 0.2, 1.0});
    const auto t = refract(w, n, eta);
    ASSERT_TRUE(t.has_value());
    EXPECT_NEAR(length(*t), 1.0, 1e-15);
    EXPECT_NEAR(length(cross(w, n) + eta * cross(*t, n)), 0.0, 1e-15);
    EXPECT_NEAR(-dot(*t, n), cos_refracted(dot(w, n), eta), 1e-15);
  }
  EXPECT_FALSE(refract(normalize(Vec3{1.0, 0.0, 0.5}), Vec3{0.0, 0.0, 1.0}, 1.0 / 1.5));
}

}  // namespace
}  // namespace lamina
