// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/slab/slab_inversion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace lamina {
namespace {

/// A sample of 1 mm, alone or between slides of glass, and the number of its layer.
struct Cell {
  bool has_slides = false;
  [[nodiscard]] LayerStack with(const Medium& sample) const {
    const Layer slide{.medium = {.ior = 1.5}, .thickness = 1.0};
    const Layer layer{.medium = sample, .thickness = 1.0};
    return has_slides ? LayerStack({slide, layer, slide}) : LayerStack({layer});
  }
  [[nodiscard]] std::size_t sample() const { return has_slides ? 1 : 0; }
};

/// Totals as by instruments that know R and T to 1e-7, and the unscattered light to 1e-5 of itself
/// or to 1e-9, whichever is more.
SlabMeasurement measured(const LayerStack& stack) {
  const AddingDoublingTotals found = adding_doubling(stack, {}, {.accuracy = 1e-9});
  const double unscattered = found.unscattered_transmittance;
  return {
      .reflectance = {found.totals.specular_reflectance + found.totals.diffuse_reflectance, 1e-7},
      .transmittance = MeasuredTotal{found.totals.transmittance, 1e-7},
      .unscattered_transmittance = MeasuredTotal{unscattered, std::max(1e-5 * unscattered, 1e-9)}};
}

// What a measurement without noise tells to 3e-5, by its own error bars, comes back to 1e-4.
TEST(SlabInversion, RandomSlabsComeBack) {
  Random random = make_random(1, 0);
  std::array<int, 3> told{};
  for (int i = 0; i < 100; ++i) {
    const double ior = 1.0 + 0.5 * random.uniform();
    const Cell cell{.has_slides = random.uniform() < 0.5};
    const double albedo = 1.0 - std::pow(10.0, -4.0 * random.uniform()) * 0.9;
    const double depth = 0.1 * std::pow(300.0, random.uniform());
    const double g = -0.3 + 1.25 * random.uniform();
    const Medium truth{
        .sigma_a = (1.0 - albedo) * depth, .sigma_s = albedo * depth, .g = g, .ior = ior};
    const SlabInversion found = invert_slab(cell.with({.sigma_s = 1.0, .g = g, .ior = ior}),
                                            cell.sample(), measured(cell.with(truth)));
    EXPECT_TRUE(found.is_accurate) << i;
    const auto expect = [&](std::size_t k, const FittedParameter& coefficient, double is,
                            double unit) {
      if (coefficient.is_at_bound || !(coefficient.high_error < 3e-5 * unit)) return;
      ++told[k];
      EXPECT_NEAR(coefficient.value, is, 1e-4 * unit)
          << i << ": coefficient " << k << ", n " << ior << ", albedo " << albedo << ", depth "
          << depth << ", g " << g;
    };
    expect(0, found.sigma_a, truth.sigma_a, truth.sigma_a);
    expect(1, found.sigma_s_prime, sigma_s_prime(truth), sigma_s_prime(truth));
    if (found.has_g) expect(2, found.g, g, 1.0);
  }
  EXPECT_GE(told[0], 55);  // not of weak absorption: 1 - R - T is known to 1e-7 only
  EXPECT_GE(told[1], 85);
  EXPECT_GE(told[2], 55);
}

// [VanDeHulst1980], as [Prahl1993] quotes it: optical thickness 2, albedo .9, g .75, no boundaries.
TEST(SlabInversion, TabulatedSlab) {
  const Cell cell;
  const SlabInversion found =
      invert_slab(cell.with({.sigma_s = 1.0}), 0,
                  {.reflectance = {0.09739, 5e-6},
                   .transmittance = MeasuredTotal{0.66096, 5e-6},
                   .unscattered_transmittance = MeasuredTotal{std::exp(-2.0), 1e-6}});
  EXPECT_NEAR(found.sigma_a.value, 0.2, 2e-4);
  EXPECT_NEAR(found.sigma_s_prime.value, 0.45, 2e-4);
  EXPECT_NEAR(found.g.value, 0.75, 2e-4);
  EXPECT_LT(found.fit.chi_squared, 1e-6);
}

// Giovanelli (1955), as [Prahl1993] quotes it: a half-space of index 1.5 and albedo .9 that
// scatters isotropically reflects .2600 in all. Reflectance alone tells a ratio.
TEST(SlabInversion, TabulatedHalfSpace) {
  const LayerStack given({{.medium = {.sigma_s = 9.0, .ior = 1.5}}}, 1.0, 1.5);
  const SlabInversion found = invert_slab(given, 0, {.reflectance = {0.2600, 5e-5}});
  EXPECT_NEAR(found.sigma_a.value, 1.0, 5e-3);
  EXPECT_FALSE(found.has_sigma_s_prime);
  EXPECT_EQ(found.sigma_s_prime.value, 9.0);
  ASSERT_EQ(found.fit.notes.size(), 1U);
  EXPECT_EQ(found.fit.notes[0],
            "sigma_s_prime: kept as given, reflectance alone tells its ratio to sigma_a only");
}

// Each total moved by its standard deviation moves a coefficient; together they are its error.
TEST(SlabInversion, ErrorsAreHowFarNoiseMovesTheCoefficients) {
  const Cell cell{.has_slides = true};
  const Medium truth{.sigma_a = 0.1, .sigma_s = 4.0, .g = 0.7, .ior = 1.37};
  SlabMeasurement measurement = measured(cell.with(truth));
  const std::array<MeasuredTotal*, 3> totals = {&measurement.reflectance,
                                                &*measurement.transmittance,
                                                &*measurement.unscattered_transmittance};
  for (MeasuredTotal* total : totals) total->standard_deviation = 1e-4 * total->value;
  const LayerStack given = cell.with({.ior = 1.37});
  const SlabInversion found = invert_slab(given, 1, measurement, {.accuracy = 1e-6});
  std::array<double, 3> moved{};
  for (MeasuredTotal* total : totals) {
    total->value += total->standard_deviation;
    const SlabInversion other = invert_slab(given, 1, measurement, {.accuracy = 1e-6});
    total->value -= total->standard_deviation;
    moved[0] = std::hypot(moved[0], other.sigma_a.value - found.sigma_a.value);
    moved[1] = std::hypot(moved[1], other.sigma_s_prime.value - found.sigma_s_prime.value);
    moved[2] = std::hypot(moved[2], other.g.value - found.g.value);
  }
  EXPECT_NEAR(found.sigma_a.high_error / moved[0], 1.0, 0.02);
  EXPECT_NEAR(found.sigma_s_prime.high_error / moved[1], 1.0, 0.02);
  EXPECT_NEAR(found.g.high_error / moved[2], 1.0, 0.02);
}

// Photons know nothing of grids of directions. Their errors are those of the measurement.
TEST(SlabInversion, PhotonsComeBackWithinTheirErrors) {
  const Cell cell{.has_slides = true};
  const Medium truth{.sigma_a = 0.1, .sigma_s = 5.0, .g = 0.8, .ior = 1.37};
  const MonteCarloResult photons = trace_photons(cell.with(truth), {.photons = 200'000, .seed = 3});
  const SlabInversion found = invert_slab(
      cell.with({.sigma_s = 1.0, .ior = 1.37}), 1,
      {.reflectance = {photons.diffuse_reflectance.value,
                       photons.diffuse_reflectance.standard_error},
       .transmittance =
           MeasuredTotal{photons.transmittance.value, photons.transmittance.standard_error},
       .unscattered_transmittance = MeasuredTotal{photons.unscattered_transmittance.value,
                                                  photons.unscattered_transmittance.standard_error},
       .has_specular = false});
  const auto expect = [](const FittedParameter& coefficient, double is, double widest) {
    EXPECT_NEAR(coefficient.value, is, 3.0 * coefficient.high_error);
    EXPECT_LT(coefficient.high_error, widest);
  };
  expect(found.sigma_a, 0.1, 0.01);
  expect(found.sigma_s_prime, 1.0, 0.02);
  expect(found.g, 0.8, 0.02);
}

// Without unscattered light, or with as little as its noise, g is what was given.
TEST(SlabInversion, KeepsWhatItCannotKnow) {
  const Cell cell;
  const Medium truth{.sigma_a = 0.05, .sigma_s = 10.0, .g = 0.8, .ior = 1.4};
  SlabMeasurement measurement = measured(cell.with(truth));
  measurement.unscattered_transmittance->standard_deviation = 1e-3;
  const LayerStack given = cell.with({.g = 0.8, .ior = 1.4});
  const SlabInversion found = invert_slab(given, 0, measurement);
  EXPECT_FALSE(found.has_g);
  EXPECT_EQ(found.g.value, 0.8);
  EXPECT_NEAR(found.sigma_a.value, 0.05, 5e-6);
  EXPECT_NEAR(found.sigma_s_prime.value, 2.0, 2e-4);
  ASSERT_EQ(found.fit.notes.size(), 1U);
  EXPECT_EQ(found.fit.notes[0],
            "g: kept as given, the unscattered transmittance is lost in its noise");
  measurement.unscattered_transmittance.reset();
  EXPECT_TRUE(invert_slab(given, 0, measurement).fit.notes.empty());
}

std::string refusal(const LayerStack& stack, const SlabMeasurement& measurement) {
  try {
    (void)invert_slab(stack, 0, measurement);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(SlabInversion, RefusesWhatIsNoMeasurement) {
  const LayerStack slab = Cell{}.with({});
  const MeasuredTotal half{0.5, 0.01};
  EXPECT_EQ(refusal(slab, {.reflectance = {-0.1, 0.01}}),
            "reflectance: must lie in [0, 1.2], but is -0.1");
  EXPECT_EQ(refusal(slab, {.reflectance = {0.5, 0.0}}),
            "reflectance: its standard deviation must be > 0, but is 0");
  EXPECT_EQ(refusal(slab, {.reflectance = half, .transmittance = MeasuredTotal{0.6, 0.01}}),
            "reflectance and transmittance: must not exceed 1 together, but are 1.1");
  EXPECT_EQ(refusal(slab, {.reflectance = half, .unscattered_transmittance = half}),
            "unscattered transmittance: needs the transmittance, too");
  EXPECT_EQ(refusal(slab, {.reflectance = {0.1, 0.01},
                           .transmittance = half,
                           .unscattered_transmittance = MeasuredTotal{0.7, 0.01}}),
            "unscattered transmittance: must not exceed the transmittance, 0.5, but is 0.7");
  EXPECT_EQ(refusal(LayerStack({{.medium = {.sigma_s = 1.0}}}),
                    {.reflectance = half, .transmittance = half}),
            "transmittance: must be missing, because the sample is infinitely thick");
}

}  // namespace
}  // namespace lamina
