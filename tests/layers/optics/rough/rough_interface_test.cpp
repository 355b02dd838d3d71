// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/rough_interface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/base/core/quadrature.h"
#include "lamina/base/core/random.h"
#include "lamina/layers/optics/rough/interface_reflectance.h"
#include "layers/optics/rough/sampler_test.h"

namespace lamina {
namespace {

constexpr std::array distributions = {MicrofacetDistribution::beckmann,
                                      MicrofacetDistribution::ggx};
constexpr double degree = std::numbers::pi / 180.0;

Vec3 direction(double theta, double phi = 0.0) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

TEST(RoughInterface, ReflectionIsReciprocalAndTransmissionWithTheSquareOfTheIndex) {
  constexpr double tiny = 1e-300;  // denormal values have fewer digits
  Random random = make_random(1, 0);
  for (const auto distribution : distributions)
    for (int i = 0; i < 2000; ++i) {
      const double alpha = 0.05 + random.uniform(), eta = std::exp(random.uniform() - 0.5);
      const RoughInterface<double> interface { {alpha, distribution}, eta };
      const Vec3 wi = direction(std::acos(1.0 - random.uniform()), 6.28 * random.uniform());
      const Vec3 wo = direction(std::acos(1.0 - random.uniform()), 6.28 * random.uniform());
      EXPECT_NEAR(brdf(interface, wi, wo), brdf(interface, wo, wi),
                  1e-10 * brdf(interface, wi, wo) + tiny);
      EXPECT_NEAR(torrance_sparrow_brdf(interface, wi, wo),
                  torrance_sparrow_brdf(interface, wo, wi),
                  1e-10 * torrance_sparrow_brdf(interface, wi, wo) + tiny);
      const RoughInterface<double> turned{interface.facets, 1.0 / eta};
      const double through = btdf(interface, wi, -wo);
      EXPECT_NEAR(through, eta * eta * btdf(turned, wo, -wi), 1e-9 * through + tiny);
    }
}

TEST(RoughInterface, SamplesFollowTheirDensityOnBothSides) {
  for (const auto distribution : distributions)
    for (const double eta : {1.4, 1.0 / 1.4})
      for (const double alpha : {0.01, 0.1, 0.4, 1.0, 4.0})
        for (const double theta : {0.0, 50.0, 89.0})
          for (const double side : {1.0, -1.0}) {
            const RoughInterface<double> interface { {alpha, distribution}, eta };
            const Vec3 wi = direction(theta * degree, 0.7);
            Random random = make_random(21, static_cast<std::uint64_t>(theta * 100.0 * alpha));
            const auto density = [&](const Vec3& wo) {
              return pdf_rough_interface(interface, wi, wo);
            };
            int found = 0;
            const double z = chi_square_deviation(
                [&]() -> std::optional<Vec3> {
                  const auto sample = sample_rough_interface(interface, wi, random.uniform(),
                                                             random.uniform(), random.uniform());
                  if (!(sample.pdf > 0.0) || sample.wo.z * side < 0.0) return std::nullopt;
                  ++found;
                  return sample.wo;
                },
                density, 40'000);
            if (found < 1000) continue;  // 3 % are reflected near the normal, nearly all at grazing
            EXPECT_LT(std::abs(z), 4.5)
                << "alpha " << alpha << " theta " << theta << " eta " << eta << " side " << side
                << " " << static_cast<int>(distribution);
          }
}

TEST(RoughInterface, WeightOfASampleIsTheBsdfOverItsDensity) {
  Random random = make_random(2, 0);
  for (const auto distribution : distributions)
    for (const double eta : {1.4, 1.0 / 1.4})
      for (int i = 0; i < 2000; ++i) {
        const RoughInterface<double> interface { {0.05 + random.uniform(), distribution}, eta };
        const Vec3 wi = direction(std::acos(1.0 - random.uniform()));
        const auto sample = sample_rough_interface(interface, wi, random.uniform(),
                                                   random.uniform(), random.uniform());
        EXPECT_GE(sample.weight, 0.0);
        EXPECT_LE(sample.weight, 1.0);
        if (sample.pdf == 0.0) continue;
        EXPECT_NEAR(sample.weight,
                    bsdf(interface, wi, sample.wo) * std::abs(sample.wo.z) / sample.pdf, 1e-7);
      }
}

// Hemispherical quadrature of the functions themselves, against the lattice of facets of the table.
TEST(InterfaceReflectance, IsTheIntegralOfTheBsdf) {
  for (const auto distribution : distributions)
    for (const double eta : {1.4, 1.0 / 1.4})
      for (const double alpha : {0.2, 1.0}) {
        const RoughInterface<double> interface { {alpha, distribution}, eta };
        const InterfaceReflectance table = make_interface_reflectance(interface);
        for (const double cos_i : {0.25, 0.75}) {  // nodes of the table
          const Vec3 wi = direction(std::acos(cos_i));
          const auto flux_to = [&](double side) {
            const Quadrature c = gauss_legendre(400, 0.0, 1.0);
            constexpr int azimuths = 400;
            double sum = 0.0;
            for (std::size_t k = 0; k < c.nodes.size(); ++k)
              for (int j = 0; j < azimuths; ++j) {
                const double phi = (j + 0.5) * 2.0 * std::numbers::pi / azimuths;
                const Vec3 w = direction(std::acos(c.nodes[k]), phi);
                sum += c.weights[k] * c.nodes[k] * bsdf(interface, wi, Vec3{w.x, w.y, side * w.z});
              }
            return sum * 2.0 * std::numbers::pi / azimuths;
          };
          // 7e-4 of the table; the edges of the lobes cost this quadrature 2e-4.
          EXPECT_NEAR(reflectance(table, cos_i), flux_to(1.0), 9e-4) << alpha << " " << eta;
          EXPECT_NEAR(transmittance(table, cos_i), flux_to(-1.0), 9e-4) << alpha << " " << eta;
        }
      }
}

TEST(InterfaceReflectance, NeverReturnsMoreThanArrives) {
  for (const auto distribution : distributions)
    for (const double eta : {2.0, 1.0, 0.5})
      for (const double alpha : {0.01, 1.0}) {
        const auto table = make_interface_reflectance({{alpha, distribution}, eta});
        for (std::size_t i = 0; i < table.reflectance.size(); ++i) {
          EXPECT_GE(table.reflectance[i], 0.0);
          EXPECT_GE(table.transmittance[i], 0.0);
          EXPECT_LE(table.reflectance[i] + table.transmittance[i], 1.0 + 1e-9);
        }
      }
}

TEST(InterfaceReflectance, TendsToFresnelAsTheSurfaceBecomesSmooth) {
  for (const auto distribution : distributions)
    for (const double eta : {1.4, 1.0 / 1.4}) {
      const auto smooth = make_interface_reflectance({{0.0, distribution}, eta});
      const auto nearly = make_interface_reflectance({{0.001, distribution}, eta});
      EXPECT_EQ(smooth.diffuse_reflectance, fresnel_diffuse(eta));
      EXPECT_NEAR(nearly.diffuse_reflectance, fresnel_diffuse(eta), 1e-3);
      for (const double cos_i : {1.0, 0.5, 0.25}) {
        EXPECT_NEAR(reflectance(nearly, cos_i), fresnel(cos_i, eta), 1e-4);
        EXPECT_NEAR(transmittance(nearly, cos_i), 1.0 - fresnel(cos_i, eta), 1e-4);
      }
    }
}

// [DonnerJensen2005] use a rough skin, light from inside: about .53 for moderate roughness, seven
// times the value from outside.
TEST(InterfaceReflectance, FromInsideIsMostlyTotalReflection) {
  const RoughInterface<double> inside{{0.1, MicrofacetDistribution::beckmann}, 1.0 / 1.4};
  const auto table = make_interface_reflectance(inside, FacetMasking::v_cavity);
  EXPECT_NEAR(table.diffuse_reflectance, 0.53, 0.01);
  EXPECT_NEAR(table.diffuse_reflectance + table.diffuse_transmittance, 1.0, 1e-4);
}

TEST(RoughInterface, WithMatchedIndicesOrNoRoughnessIsASmoothOne) {
  const Vec3 wi = direction(40.0 * degree);
  const auto through = sample_rough_interface<double>({{.alpha = 0.5}, 1.0}, wi, 0.3, 0.4, 0.1);
  EXPECT_TRUE(through.is_specular);
  EXPECT_NEAR(length(through.wo + wi), 0.0, 1e-15);
  const RoughInterface<double> smooth{{.alpha = 0.0}, 1.5};
  const auto mirrored = sample_rough_interface(smooth, wi, 0.3, 0.4, 0.0);
  EXPECT_NEAR(length(mirrored.wo - Vec3{-wi.x, -wi.y, wi.z}), 0.0, 1e-15);
  EXPECT_EQ(bsdf(smooth, wi, mirrored.wo), 0.0);
}

}  // namespace
}  // namespace lamina
