// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/multiple_scattering.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "lamina/layers/optics/rough/interface_reflectance.h"
#include "layers/optics/facet_furnace.h"

namespace lamina {
namespace {

constexpr std::array distributions = {MicrofacetDistribution::beckmann,
                                      MicrofacetDistribution::ggx};
constexpr double degree = std::numbers::pi / 180.0;

Vec3 direction(double theta, double phi = 0.0) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

struct Mean {
  double sum = 0.0, sum2 = 0.0;
  int n = 0;
  void add(double x) { sum += x, sum2 += x * x, ++n; }
  [[nodiscard]] double value() const { return sum / n; }
  [[nodiscard]] double standard_error() const {
    return std::sqrt(std::max(0.0, sum2 / n - value() * value()) / (n - 1));
  }
};

/// A direction on the sphere with density |cos| / 2 pi.
Vec3 sample_cosine(Random& random) {
  const double c = std::sqrt(1.0 - random.uniform()),
               phi = 2.0 * std::numbers::pi * random.uniform();
  const Vec3 w = direction(std::acos(c), phi);
  return random.uniform() < 0.5 ? w : Vec3{w.x, w.y, -w.z};
}

// The white furnace, for evaluation, which is not normalized by construction; s = 2 / alpha. With
// more walks, tools/tables/furnace_table.cpp.
TEST(MultipleScattering, EvaluationReturnsAllTheLight) {
  double chi_square = 0.0;
  int cases = 0;
  for (const double s : {0.5, 1.0, 2.0, 3.0, 6.0, 10.0})
    for (const double eta : {1.4, 1.0 / 1.4}) {
      const double theta = (17 * ++cases % 86) * degree;
      Random random = make_random(7, static_cast<std::uint64_t>(cases));
      const FacetFurnace furnace =
          facet_furnace({{.alpha = 2.0 / s}, eta}, direction(theta), 10'000, random);
      const double error = std::hypot(furnace.higher.standard_error, 1e-4);  // and the quadrature
      const double deviation = (furnace.total() - 1.0) / error;
      EXPECT_LT(std::abs(deviation), 4.0) << "s " << s << " eta " << eta << " theta " << theta;
      EXPECT_LT(error, 0.01);
      chi_square += deviation * deviation;
    }
  EXPECT_LT(chi_square, 30.0);  // of 12
}

// The same with directions drawn without regard to the facets, for the function as it is called.
TEST(MultipleScattering, EvaluationReturnsAllTheLightInDirectionsOfAnyKind) {
  for (const double eta : {1.4, 1.0 / 1.4}) {
    const RoughInterface<double> interface { {.alpha = 1.0}, eta };
    const Vec3 wi = direction(60.0 * degree);
    Random random = make_random(8, 1);
    Mean flux;
    for (int i = 0; i < 40'000; ++i)
      flux.add(2.0 * std::numbers::pi *
               evaluate_multiple_scattering(interface, wi, sample_cosine(random), random));
    EXPECT_NEAR(flux.value(), 1.0, 4.0 * flux.standard_error());
    EXPECT_LT(flux.standard_error(), 0.03);
  }
}

TEST(MultipleScattering, OrderOneIsTheClosedForm) {
  for (const auto distribution : distributions)
    for (const double eta : {1.4, 1.0 / 1.4}) {
      const RoughInterface<double> interface { {0.8, distribution}, eta };
      const InterfaceReflectance table = make_interface_reflectance(interface);
      for (const double cos_i : {0.25, 0.75}) {
        Random random = make_random(8, 0);
        constexpr int walks = 100'000;
        int reflected = 0, transmitted = 0;
        for (int i = 0; i < walks; ++i) {
          const auto sample =
              sample_multiple_scattering(interface, direction(std::acos(cos_i)), random);
          ASSERT_GE(sample.order, 1);
          if (sample.order == 1) ++(sample.wo.z > 0.0 ? reflected : transmitted);
        }
        // 7e-4 is the table's own error.
        const auto error = [&](double p) { return 4.0 * std::sqrt(p * (1.0 - p) / walks) + 7e-4; };
        const double r = reflectance(table, cos_i), t = transmittance(table, cos_i);
        EXPECT_NEAR(1.0 * reflected / walks, r, error(r));
        EXPECT_NEAR(1.0 * transmitted / walks, t, error(t));
      }
    }
}

// Evaluation and sampling are two estimates of the light that leaves into a part of the sphere.
void expect_samples_follow_evaluation(const RoughInterface<double>& interface, double theta,
                                      int samples) {
  const Vec3 wi = direction(theta);
  const auto part = [](const Vec3& w) {
    return (w.z > 0.0 ? 0 : 4) + (w.x > 0.0 ? 0 : 2) + (std::abs(w.z) > 0.6 ? 0 : 1);
  };
  std::array<Mean, 8> sampled, evaluated;
  Random random = make_random(9, 0);
  for (int i = 0; i < samples; ++i) {
    const int to = part(sample_multiple_scattering(interface, wi, random).wo);
    const Vec3 wo = sample_cosine(random);
    const double flux =
        evaluate_multiple_scattering(interface, wi, wo, random) * 2.0 * std::numbers::pi;
    for (int k = 0; k < 8; ++k) {
      sampled[static_cast<std::size_t>(k)].add(k == to ? 1.0 : 0.0);
      evaluated[static_cast<std::size_t>(k)].add(k == part(wo) ? flux : 0.0);
    }
  }
  double chi_square = 0.0;
  for (std::size_t k = 0; k < 8; ++k) {
    const double error = std::hypot(sampled[k].standard_error(), evaluated[k].standard_error());
    const double deviation = (sampled[k].value() - evaluated[k].value()) / (error + 1e-5);
    EXPECT_LT(std::abs(deviation), 4.5) << "part " << k;
    chi_square += deviation * deviation;
  }
  EXPECT_LT(chi_square, 40.0)  // of 8; evaluation has long tails, which enlarge it
      << "alpha " << interface.facets.alpha << " eta " << interface.eta << " theta " << theta;
}

TEST(MultipleScattering, EvaluationAgreesWithSampling) {
  for (const auto distribution : distributions)
    for (const double eta : {1.4, 1.0 / 1.4})
      expect_samples_follow_evaluation({{1.0, distribution}, eta}, 50.0 * degree, 60'000);
}

TEST(MultipleScattering, EvaluationAgreesWithSamplingAtEitherEndOfSmoothnessAndAtGrazing) {
  for (const double eta : {1.4, 1.0 / 1.4})
    for (const double s : {0.5, 10.0})
      for (const double theta : {0.0, 85.0})
        expect_samples_follow_evaluation({{.alpha = 2.0 / s}, eta}, theta * degree, 20'000);
}

TEST(MultipleScattering, IsReciprocalAcrossTheInterface) {
  const double eta = 1.4;
  const RoughInterface<double> interface { {1.2}, eta }, turned{{1.2}, 1.0 / eta};
  const Vec3 wi = direction(0.9), wo = direction(0.5, 2.0);
  Random random = make_random(10, 0);
  Mean there, back, up, down;
  for (int i = 0; i < 100'000; ++i) {
    there.add(evaluate_multiple_scattering(interface, wi, -wo, random));
    back.add(eta * eta * evaluate_multiple_scattering(turned, wo, -wi, random));
    up.add(evaluate_multiple_scattering(interface, wi, wo, random));
    down.add(evaluate_multiple_scattering(interface, wo, wi, random));
  }
  EXPECT_NEAR(there.value(), back.value(),
              4.0 * std::hypot(there.standard_error(), back.standard_error()));
  EXPECT_NEAR(up.value(), down.value(),
              4.0 * std::hypot(up.standard_error(), down.standard_error()));
  // Order 1 alone is reciprocal by formula; the test needs a good part of higher orders.
  EXPECT_GT(up.value(), 1.15 * brdf(interface, wi, wo));
}

TEST(MultipleScattering, FillsTheReflectanceTableUpToAllTheLight) {
  for (const double eta : {1.4, 1.0 / 1.4}) {
    const RoughInterface<double> interface { {1.0}, eta };
    const auto table = make_interface_reflectance(interface, FacetMasking::smith_multiple);
    EXPECT_NEAR(table.diffuse_reflectance + table.diffuse_transmittance, 1.0, 1e-4);
    for (const double cos_i : {0.3, 0.8}) {
      Random random = make_random(12, 0);
      constexpr int walks = 60'000;
      int reflected = 0;
      for (int i = 0; i < walks; ++i)
        if (sample_multiple_scattering(interface, direction(std::acos(cos_i)), random).wo.z > 0.0)
          ++reflected;
      const double r = reflectance(table, cos_i);
      EXPECT_NEAR(r + transmittance(table, cos_i), 1.0, 1e-12);
      // Half of the light meets several facets, of which the table knows the share to 2 %.
      EXPECT_NEAR(1.0 * reflected / walks, r, 4.0 * std::sqrt(r * (1.0 - r) / walks) + 0.01);
    }
  }
}

// Reciprocity for diffuse light: what passes into the denser medium is eta^2 times what passes out.
// So roughness hardly changes the diffuse reflectance from inside, which single scattering misses.
TEST(MultipleScattering, DiffuseTransmittanceFromInsideIsThatFromOutsideOverTheSquareOfTheIndex) {
  const double eta = 1.4;
  for (const double alpha : {0.1, 0.4}) {
    const auto outside = make_interface_reflectance({{alpha}, eta}, FacetMasking::smith_multiple);
    const auto inside =
        make_interface_reflectance({{alpha}, 1.0 / eta}, FacetMasking::smith_multiple);
    EXPECT_NEAR(inside.diffuse_transmittance, outside.diffuse_transmittance / (eta * eta), 2e-3);
    EXPECT_NEAR(inside.diffuse_reflectance, 0.52, 0.01);
  }
}

TEST(MultipleScattering, OfASmoothInterfaceIsFresnel) {
  Random random = make_random(11, 0);
  const Vec3 wi = direction(1.0);
  int reflected = 0;
  constexpr int walks = 100'000;
  for (int i = 0; i < walks; ++i) {
    const auto sample = sample_multiple_scattering({{.alpha = 0.0}, 1.5}, wi, random);
    EXPECT_EQ(sample.order, 1);
    if (sample.wo.z > 0.0) ++reflected;
  }
  const double f = fresnel(wi.z, 1.5);
  EXPECT_NEAR(1.0 * reflected / walks, f, 4.0 * std::sqrt(f * (1.0 - f) / walks));
}

}  // namespace
}  // namespace lamina
