// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/integrating_sphere/integrating_sphere.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "lamina/base/core/error.h"
#include "solve/integrating_sphere/bouncing_rays.h"

namespace lamina {
namespace {

/// With ports that matter.
IntegratingSphere small_sphere(bool has_baffle) {
  return {.diameter = has_baffle ? 100.0 : 50.0,
          .sample_port = 18.0,
          .detector_port = 18.0,
          .entrance_port = 10.0,
          .wall_reflectance = 0.95,
          .detector_reflectance = 0.3,
          .standard_reflectance = 0.9,
          .has_baffle = has_baffle};
}

double share(double port, double sphere) {
  return 0.5 * (1.0 - std::sqrt(1.0 - port * port / (sphere * sphere)));
}

// Rays between wall, flat ports and a baffle know nothing of gains.
TEST(IntegratingSphere, ReadsWhatBouncingRaysGive) {
  for (const bool has_baffle : {false, true}) {
    const IntegratingSphere sphere = small_sphere(has_baffle);
    constexpr double r = 0.3;
    constexpr SampleLight light{.scattered = 0.35, .straight = 0.06};
    const int rays = has_baffle ? 200'000 : 600'000;
    BouncingRays with_sample(sphere, r), with_standard(sphere, 0.9), empty(sphere, 0.0);
    const double scattered = with_sample.signal(false, rays, 1);
    const double straight = with_sample.signal(true, rays, 2);
    const double standard = with_standard.signal(false, rays, 3);
    const double all = empty.signal(true, rays, 4);
    const double signal = light.scattered * scattered + light.straight * straight;
    // Light meets the detector up to once or twice a ray, so that these are four standard errors.
    const double noise = 4.0 * std::sqrt(2.0 / (scattered * rays));
    EXPECT_LT(noise, has_baffle ? 0.04 : 0.016);
    EXPECT_NEAR(reflectance_reading(sphere, light, r).value / (signal / standard), 1.0, noise);
    IntegratingSphere plain = sphere;
    plain.standard_reflectance = sphere.wall_reflectance;
    EXPECT_NEAR(transmittance_reading(plain, light, r).value / (signal / all), 1.0, noise);
  }
}

TEST(IntegratingSphere, OfSmallPortsReadsWhatThereIs) {
  const SampleLight light{.scattered = 0.35, .straight = 0.05};
  for (const SphereMethod method : {SphereMethod::substitution, SphereMethod::comparison}) {
    IntegratingSphere sphere{.diameter = 1e4, .sample_port = 1.0, .detector_port = 1.0};
    sphere.method = method;
    EXPECT_NEAR(reflectance_reading(sphere, light, 0.4).value, 0.4, 1e-6);
    EXPECT_NEAR(transmittance_reading(sphere, light, 0.4).value, 0.35 * 0.98 / 0.99 + 0.05,
                1e-6);  // opposite to the sample is a better wall
    sphere.has_baffle = false;
    sphere.wall_reflectance = sphere.standard_reflectance = 1.0 - 1e-9;
    sphere.detector_port = 10.0;
    EXPECT_NEAR(transmittance_reading(sphere, light, 1.0).value, 0.4, 1e-2);
  }
}

// A closed white sphere loses light to detector and sample only, which share it by what they take.
TEST(IntegratingSphere, WhiteWallsGiveAllLightToWhatAbsorbs) {
  IntegratingSphere sphere = small_sphere(false);
  sphere.entrance_port = 0.0;
  sphere.wall_reflectance = 1.0 - 1e-10;
  sphere.standard_reflectance = 1.0;
  const double a = share(18.0, 50.0), r = 0.6;  // the detector: 0.3
  const auto taken = [&](double reflectance) {
    return a * (1.0 - reflectance) / (1.0 - a * (1.0 - reflectance));
  };
  EXPECT_NEAR(reflectance_reading(sphere, {.straight = 1.0}, r).value,
              taken(sphere.detector_reflectance) / (taken(sphere.detector_reflectance) + taken(r)),
              1e-7);
}

// [Pickering1993] without baffle, [Prahl2011] with it, which take flat ports for parts of the wall.
TEST(IntegratingSphere, AgreesWithPublishedFormulasButForFlatPorts) {
  IntegratingSphere sphere{.diameter = 200.0,
                           .sample_port = 10.0,
                           .detector_port = 6.0,
                           .entrance_port = 8.0,
                           .detector_reflectance = 0.1};
  const double a_s = share(10.0, 200.0), a_d = share(6.0, 200.0), a_e = share(8.0, 200.0);
  const double a_w = 1.0 - a_s - a_d - a_e, r_w = 0.98, r_d = 0.1;
  const SampleLight light{.scattered = 0.35};
  const auto expect_gain = [&](const auto& published) {
    const double ratio = published(0.99) / published(0.3);
    EXPECT_GT(std::abs(ratio - 1.0), 0.01);
    EXPECT_NEAR(reflectance_reading(sphere, light, 0.3).value / (0.35 * ratio), 1.0, a_s);
  };
  sphere.has_baffle = false;
  expect_gain([&](double r) { return 1.0 - a_w * r_w - a_d * r_d - a_s * r; });
  sphere.has_baffle = true;
  expect_gain([&](double r) { return 1.0 - r_w * (a_w + (1.0 - a_e) * (a_d * r_d + a_s * r)); });
}

TEST(IntegratingSphere, ComparisonDoesNotDependOnTheGain) {
  IntegratingSphere sphere = small_sphere(true);
  sphere.method = SphereMethod::comparison;
  EXPECT_NEAR(reflectance_reading(sphere, {.scattered = 0.35}, 0.1).value, 0.35, 1e-15);
  sphere.has_baffle = false;  // but a flat sample does not light itself
  EXPECT_NEAR(reflectance_reading(sphere, {.scattered = 0.35}, 0.9).value, 0.35, 1e-15);
  EXPECT_GT(reflectance_reading(sphere, {.scattered = 0.35}, 0.1).value, 0.352);
}

TEST(IntegratingSphere, DerivativesAreThoseOfItsReadings) {
  for (const bool has_baffle : {false, true})
    for (const SphereMethod method : {SphereMethod::substitution, SphereMethod::comparison}) {
      IntegratingSphere sphere = small_sphere(has_baffle);
      sphere.method = method;
      const auto expect_slopes = [&](const auto& read) {
        const SphereReading at = read(sphere, SampleLight{0.3, 0.1}, 0.5);
        constexpr double h = 1e-5;
        const auto slope = [&](double scattered, double straight, double r) {
          const auto by = [&](double step) {
            return read(sphere, SampleLight{0.3 + step * scattered, 0.1 + step * straight},
                        0.5 + step * r)
                .value;
          };
          return (by(h) - by(-h)) / (2.0 * h);
        };
        EXPECT_NEAR(at.by_scattered, slope(1, 0, 0), 1e-9);
        EXPECT_NEAR(at.by_straight, slope(0, 1, 0), 1e-9);
        EXPECT_NEAR(at.by_diffuse_reflectance, slope(0, 0, 1), 1e-9);
      };
      expect_slopes([](auto... is) { return reflectance_reading(is...); });
      expect_slopes([](auto... is) { return transmittance_reading(is...); });
    }
}

TEST(IntegratingSphere, RefusesWhatIsNoSphere) {
  const auto refusal = [](IntegratingSphere sphere) -> std::string {
    try {
      check_sphere(sphere);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "(taken)";
  };
  EXPECT_EQ(refusal({}), "(taken)");
  EXPECT_EQ(refusal({.diameter = 0.0}), "diameter must be > 0 [mm], but is 0");
  EXPECT_EQ(refusal({.diameter = 50.0, .sample_port = 60.0}),
            "sample_port must be smaller than the sphere, 50 mm, but is 60");
  EXPECT_EQ(refusal({.entrance_port = -1.0}), "entrance_port must be >= 0 [mm], but is -1");
  EXPECT_EQ(refusal({.diameter = 50.0, .sample_port = 45.0, .detector_port = 45.0}).substr(0, 66),
            "the share of the sphere that its ports take must be <= 0.5, but is");
  EXPECT_EQ(refusal({.wall_reflectance = 1.0}), "wall_reflectance must lie in (0, 1), but is 1");
  EXPECT_EQ(refusal({.standard_reflectance = 0.0}),
            "standard_reflectance must lie in (0, 1], but is 0");
}

}  // namespace
}  // namespace lamina
