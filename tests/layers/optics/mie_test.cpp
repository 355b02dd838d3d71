// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/mie.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"

namespace lamina {
namespace {

// [Wiscombe1979] "Mie scattering calculations", NCAR/TN-140, test cases, six digits given.
TEST(MieSphere, AgreesWithWiscombesTable) {
  struct Row {
    std::complex<double> m;
    double x, extinction, scattering, g;
  };
  for (const Row& row : {Row{{1.5, 0.0}, 10.0, 2.881999, 2.881999, 0.742913},
                         Row{{1.5, 0.0}, 100.0, 2.094388, 2.094388, 0.818246},
                         Row{{1.5, 0.0}, 1000.0, 2.013945, 2.013945, 0.827882},
                         Row{{1.33, 1e-5}, 1.0, 0.093952, 0.093923, 0.184517},
                         Row{{1.33, 1e-5}, 100.0, 2.101321, 2.096594, 0.868959},
                         Row{{1.33, 1e-5}, 10000.0, 2.004089, 1.723857, 0.907840},
                         Row{{1.5, 1.0}, 1.0, 2.336321, 0.663454, 0.192136},
                         Row{{1.5, 1.0}, 100.0, 2.097502, 1.283697, 0.850252},
                         Row{{10.0, 10.0}, 1.0, 2.532993, 2.049405, -0.110664},
                         Row{{10.0, 10.0}, 100.0, 2.071124, 1.836785, 0.556215}}) {
    const MieSphere sphere = mie_sphere(row.x, row.m);
    EXPECT_NEAR(sphere.extinction, row.extinction, 1.5e-6) << row.m << ' ' << row.x;
    EXPECT_NEAR(sphere.scattering, row.scattering, 1.5e-6) << row.m << ' ' << row.x;
    EXPECT_NEAR(sphere.g, row.g, 1.5e-6) << row.m << ' ' << row.x;
  }
}

// Small spheres scatter as Rayleigh's: 8/3 x^4 |(m² - 1)/(m² + 2)|².
TEST(MieSphere, TendsToRayleighWhenSmall) {
  const double x = 1e-3, m = 1.4;
  const double polarizability = (m * m - 1.0) / (m * m + 2.0);
  const double rayleigh = 8.0 / 3.0 * std::pow(x, 4) * polarizability * polarizability;
  EXPECT_NEAR(mie_sphere(x, m).scattering / rayleigh, 1.0, 1e-4);
  EXPECT_NEAR(mie_sphere(x, m).g, 0.0, 1e-4);
  const std::vector<double> phase = mie_phase(x, m, std::vector{0.0, 1.0});
  EXPECT_NEAR(phase[1] / phase[0], 2.0, 1e-4);
}

TEST(MieSphere, LargeSpheresTakeTwiceTheirShadow) {
  EXPECT_NEAR(mie_sphere(3e4, {1.5, 0.1}).extinction, 2.0, 5e-3);
}

TEST(MiePhase, HasUnitIntegralAndTheMeanCosineOfTheSeries) {
  const Quadrature rule = gauss_legendre(400);
  for (const double x : {0.5, 5.0, 60.0}) {
    const std::vector<double> phase = mie_phase(x, {1.2, 0.01}, rule.nodes);
    double integral = 0.0, cosine = 0.0;
    for (std::size_t i = 0; i < phase.size(); ++i) {
      integral += 2.0 * std::numbers::pi * rule.weights[i] * phase[i];
      cosine += 2.0 * std::numbers::pi * rule.weights[i] * phase[i] * rule.nodes[i];
    }
    EXPECT_NEAR(integral, 1.0, 1e-9) << x;
    EXPECT_NEAR(cosine, mie_sphere(x, {1.2, 0.01}).g, 1e-9) << x;
  }
}

// The series has as many terms as the size parameter; unbounded, it takes all memory.
TEST(MieSphere, RefusesSeriesWithoutEnd) {
  EXPECT_THROW((void)mie_sphere(1.01e5, 1.5), InvalidInput);
  EXPECT_THROW((void)mie_sphere(1.0, 1e9), InvalidInput);
  EXPECT_THROW((void)mie_phase(1.0, {1.0, 101.0}, {}), InvalidInput);
  const Particles pebbles{.volume_fraction = 0.1, .median_radius = 10.0, .sigma_log_radius = 1.5};
  EXPECT_THROW((void)mie_bulk(pebbles, 1.33, 550.0), InvalidInput);
  EXPECT_NO_THROW((void)mie_sphere(9.9e4, 1.33));
}

TEST(MieBulk, OfOneSizeIsNumberTimesCrossSection) {
  const Particles beads{.volume_fraction = 0.01, .median_radius = 0.5e-3, .ior = 1.59};
  const double x = 2.0 * std::numbers::pi * 1.33 * 0.5e-3 / 633e-6;
  const MieSphere sphere = mie_sphere(x, 1.59 / 1.33);
  const MieBulk bulk = mie_bulk(beads, 1.33, 633.0);
  EXPECT_NEAR(bulk.sigma_s, 0.75 * 0.01 * sphere.scattering / 0.5e-3, 1e-9 * bulk.sigma_s);
  EXPECT_NEAR(bulk.g, sphere.g, 1e-12);
  EXPECT_EQ(bulk.sigma_a, 0.0);
}

// A narrow spread changes little, and the quadrature finds the volume of a wide one:
// weak absorption by small grains depends on their volume alone.
TEST(MieBulk, WeakAbsorptionOfSmallGrainsDependsOnVolumeAlone) {
  const auto sigma_a = [](double spread) {
    return mie_bulk({.volume_fraction = 0.02,
                     .median_radius = 2e-6,
                     .sigma_log_radius = spread,
                     .ior = {1.0001, 1e-6}},
                    1.0, 500.0)
        .sigma_a;
  };
  const double bulk = 0.02 * 4.0 * std::numbers::pi * 1e-6 / 500e-6;  // fraction x 4 pi k / lambda
  EXPECT_NEAR(sigma_a(0.0) / bulk, 1.0, 1e-3);
  EXPECT_NEAR(sigma_a(0.6) / bulk, 1.0, 1e-3);
}

}  // namespace
}  // namespace lamina
