// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/gaussian_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/base/core/quadrature.h"
#include "lamina/base/core/random.h"
#include "layers/optics/rough/sampler_test.h"

namespace lamina {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

Vec3 direction(double theta, double phi = 0.0) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Eq. 25 written out with the paper's symbols.
double printed_btdf(double s, double n, const Vec3& wi, const Vec3& wo) {
  Vec3 h = -(wi + n * wo);
  h = normalize(h.z > 0.0 ? h : -h);
  const double cos_alpha = dot(wi, h), cos_beta = -dot(wo, h);
  if (cos_alpha <= 0.0 || cos_beta <= 0.0) return 0.0;
  const double chi = n * n * cos_beta / std::pow(cos_alpha - n * cos_beta, 2);
  const double tan2 = (1.0 - h.z * h.z) / (h.z * h.z);
  const auto V = [&](const Vec3& w) {
    const double tan_theta = std::hypot(w.x, w.y) / std::abs(w.z);
    if (tan_theta == 0.0) return 1.0;
    return std::exp(-0.7 * tan_theta / s * std::exp(-s * s / (4.0 * tan_theta * tan_theta)));
  };
  return s * s * cos_alpha * (1.0 - fresnel(std::min(cos_alpha, 1.0), n)) *
         std::exp(-s * s * tan2 / 4.0) /
         (4.0 * std::numbers::pi * wi.z * -wo.z * std::pow(h.z, 4)) * chi * V(wi) * V(wo);
}

TEST(GaussianSurface, TransmitsAsEquation25) {
  Random random = make_random(1, 0);
  for (int i = 0; i < 2000; ++i) {
    const double s = 0.5 + 6.0 * random.uniform();
    const double n = i % 2 == 0 ? 1.2 + random.uniform() : 1.0 / (1.2 + random.uniform());
    const Vec3 wi = direction(1.5 * random.uniform());
    const Vec3 wo = -direction(1.5 * random.uniform(), 6.28 * random.uniform());
    const double printed = printed_btdf(s, n, wi, wo);
    EXPECT_NEAR(single_scattering_btdf({s, n}, wi, wo), printed, 1e-9 * printed + 1e-200);
  }
}

// [Sun2007]: D F V V / (4 cos cos) with the Beckmann density of slopes.
TEST(GaussianSurface, ReflectsAsSun) {
  const GaussianSurface surface{2.0, 1.5};
  const Vec3 wi = direction(0.5), wo = direction(0.9, 2.0);
  const Vec3 h = normalize(wi + wo);
  const double tan2 = (1.0 - h.z * h.z) / (h.z * h.z);
  const double D = 4.0 * std::exp(-tan2) / (4.0 * std::numbers::pi * std::pow(h.z, 4));
  EXPECT_NEAR(single_scattering_brdf(surface, wi, wo),
              D * fresnel(dot(wi, h), 1.5) * visibility(surface, wi) * visibility(surface, wo) /
                  (4.0 * wi.z * wo.z),
              1e-14);
}

// Made with an independent quadrature over the sphere of directions.
TEST(GaussianSurface, TransmitsItsHemisphericalFractions) {
  const auto transmittance = [](double s, double n, double theta) {
    return single_scattering_fractions({s, n}, std::cos(theta * degree)).transmittance;
  };
  EXPECT_NEAR(transmittance(6.0, 1.4, 30.0), 0.9682, 1.5e-4);
  EXPECT_NEAR(transmittance(1.0, 1.4, 0.0), 0.8567, 1.5e-4);
  EXPECT_NEAR(transmittance(6.0, 1.0 / 1.4, 0.0), 0.9702, 1.5e-4);
  EXPECT_NEAR(transmittance(3.0, 1.0 / 1.4, 30.0), 0.6678, 1.5e-4);
}

// [XuSun2008] Figure 6, s = 1: the lobe is a ring, for few facets of so rough a surface are level.
TEST(GaussianSurface, HasAnIndentedLobeWhenRough) {
  const GaussianSurface surface{1.0, 1.4};
  const auto lobe = [&](double theta) {
    return single_scattering_btdf(surface, {0.0, 0.0, 1.0}, -direction(theta * degree)) *
           std::cos(theta * degree);
  };
  double best = 0.0;
  for (double theta = 0.0; theta < 89.0; theta += 0.1)
    if (lobe(theta) > lobe(best)) best = theta;
  EXPECT_NEAR(best, 18.5, 0.2);
  EXPECT_GT(lobe(best), 1.05 * lobe(0.0));
}

TEST(GaussianSurface, SamplesCarryTheBsdfOverTheirDensity) {
  Random random = make_random(3, 0);
  for (int i = 0; i < 2000; ++i) {
    const GaussianSurface surface{0.5 + 5.0 * random.uniform(), i % 2 == 0 ? 1.4 : 1.0 / 1.4};
    const Vec3 wi = direction(1.55 * random.uniform());
    const auto sample =
        sample_single_scattering(surface, wi, random.uniform(), random.uniform(), random.uniform());
    EXPECT_LE(sample.weight, 1.0 + 1e-9);
    if (sample.pdf == 0.0) continue;
    EXPECT_NEAR(sample.weight,
                single_scattering_bsdf(surface, wi, sample.wo) * std::abs(sample.wo.z) / sample.pdf,
                1e-9);
  }
}

TEST(GaussianSurface, SamplesFollowTheirDensityOnBothSides) {
  for (const double s : {0.5, 3.0, 10.0})
    for (const double eta : {1.4, 1.0 / 1.4})
      for (const double theta : {0.0, 85.0})
        for (const double side : {1.0, -1.0}) {
          const GaussianSurface surface{s, eta};
          const Vec3 wi = direction(theta * degree, 0.3);
          Random random = make_random(22, static_cast<std::uint64_t>(10.0 * s * eta + theta));
          int found = 0;
          const double z = chi_square_deviation(
              [&]() -> std::optional<Vec3> {
                const auto sample = sample_single_scattering(surface, wi, random.uniform(),
                                                             random.uniform(), random.uniform());
                if (!(sample.pdf > 0.0) || sample.wo.z * side < 0.0) return std::nullopt;
                ++found;
                return sample.wo;
              },
              [&](const Vec3& wo) {
                return pdf_rough_interface(make_rough_interface(surface), wi, wo);
              },
              40'000);
          if (found < 1000) continue;
          EXPECT_LT(std::abs(z), 4.5)
              << "s " << s << " eta " << eta << " theta " << theta << " side " << side;
        }
}

}  // namespace
}  // namespace lamina
