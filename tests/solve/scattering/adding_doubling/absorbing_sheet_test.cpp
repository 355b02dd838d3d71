// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/absorbing_sheet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina {
namespace {

Layer of(double sigma_a, double sigma_s, double g, double ior, double thickness) {
  return {.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
          .thickness = thickness};
}

LayerStack painted(const Layer& film) {
  return LayerStack({of(.05, 10, .8, 1.4, .3), film, of(.02, 20, .6, 1.4, .2)});
}

/// As thick as photons see it well, and not too thick for them to go to the side in it.
Layer thin_absorber(double optical_density, double ior) {
  constexpr double thickness = 1e-4;
  return of(optical_density * std::log(10.0) / thickness, 0, 0, ior, thickness);
}

// Alone in air: Beer and Lambert, and with an index of its own the two reflections of a plate.
TEST(AbsorbingSheet, FollowsBeerLambert) {
  constexpr double density = .4;
  for (const double theta : {0.0, .6, 1.2})
    for (const double ior : {1.0, 1.5}) {
      const auto found = adding_doubling(LayerStack({absorbing_sheet(density, ior)}),
                                         {.theta = theta}, {.accuracy = 1e-8});
      const double cos_inside = std::sqrt(1.0 - std::pow(std::sin(theta) / ior, 2));
      const double passed = std::pow(10.0, -density / cos_inside),
                   f = fresnel(std::cos(theta), ior);
      const double through = (1 - f) * (1 - f) * passed / (1 - f * f * passed * passed);
      EXPECT_NEAR(found.totals.transmittance, through, 1e-10);
      EXPECT_NEAR(found.totals.specular_reflectance + found.totals.diffuse_reflectance,
                  f + f * passed * through, 1e-10);
    }
}

TEST(AbsorbingSheet, DensitiesAdd) {
  const LayerStack one = painted(absorbing_sheet(.7, 1.4));
  const LayerStack two({of(.05, 10, .8, 1.4, .3), absorbing_sheet(.5, 1.4),
                        absorbing_sheet(.2, 1.4), of(.02, 20, .6, 1.4, .2)});
  const auto a = adding_doubling(one), b = adding_doubling(two);
  EXPECT_NEAR(a.totals.diffuse_reflectance, b.totals.diffuse_reflectance, 1e-9);
  EXPECT_NEAR(a.totals.transmittance, b.totals.transmittance, 1e-9);
}

// Photons through a layer of finite thickness: totals, and how far light gets.
TEST(AbsorbingSheet, IsTheLimitOfAThinAbsorberForPhotons) {
  constexpr double ior = 1.7;
  MonteCarloOptions options{.photons = 200'000, .seed = 5};
  constexpr double ring = .1;
  options.tallies.r = {.count = 10, .width = ring};
  const auto photons = trace_photons(painted(thin_absorber(.5, ior)), options);
  const std::vector sheet{painted(absorbing_sheet(.5, ior))};
  const SlabTotals totals = adding_doubling(sheet[0]).totals;
  const auto expect = [&](const char* what, double value, const Estimate& estimate) {
    EXPECT_NEAR(value, estimate.value, 4.0 * estimate.standard_error) << what;
  };
  expect("R", totals.diffuse_reflectance, photons.diffuse_reflectance);
  expect("absorbed", totals.absorptance[1], photons.absorptance[1]);
  const auto solved = transfer_profile(sheet, {.first = 1e-3, .last = 20.0, .size = 120});
  for (std::size_t i = 1; i + 1 < 10; ++i)
    for (const bool is_reflected : {true, false}) {
      double mean = 0.0, area = 0.0;
      for (int q = 0; q < 20; ++q) {
        const double r = ring * (static_cast<double>(i) + (q + .5) / 20.0);
        mean += r * (is_reflected ? reflectance_profile(solved.profile, r, 0)
                                  : transmittance_profile(solved.profile, r, 0));
        area += r;
      }
      mean /= area;
      const Estimate& seen =
          is_reflected ? photons.radial.reflection[i] : photons.radial.transmission[i];
      EXPECT_NEAR(mean, seen.value, 4.0 * std::hypot(seen.standard_error, .01 * mean))
          << (is_reflected ? "R" : "T") << " ring " << i;
    }
}

}  // namespace
}  // namespace lamina
