// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/patch_photons.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

LayerStack skin() {
  return LayerStack(
      {{.medium = {1.0, 20.0, 0.7, 1.4}, .thickness = 0.1}, {.medium = {0.3, 15.0, 0.8, 1.38}}},
      1.0, 1.38);
}

Estimate mean(const std::vector<Estimate>& texels) {
  Estimate sum;
  for (const Estimate& e : texels) {
    sum.value += e.value / double(texels.size());
    sum.standard_error = std::hypot(sum.standard_error, e.standard_error / double(texels.size()));
  }
  return sum;
}

void expect_within(const Estimate& estimate, double reference, double standard_errors = 4.0) {
  EXPECT_NEAR(estimate.value, reference, standard_errors * estimate.standard_error);
  EXPECT_LT(estimate.standard_error, 0.02 * reference);
}

TEST(PatchPhotons, OfUniformMapsAreThoseOfTheStack) {
  Patch patch{.stack = skin(), .columns = 3, .rows = 2, .texel = 0.05};
  patch.stack = LayerStack(
      {{.medium = {9.0, 20.0, 0.7, 1.4}, .thickness = 0.1}, {.medium = {0.3, 15.0, 0.8, 1.38}}},
      1.0, 1.38);
  patch.sigma_a = {std::vector(6, 1.0)};  // in place of the layer's 9
  for (const Incidence incidence : {Incidence{}, {.theta = 0.8}, {.is_diffuse = true}}) {
    const auto photons =
        trace_patch_photons(patch, {.photons = 40'000, .seed = 3, .incidence = incidence});
    expect_within(mean(photons.exitance),
                  adding_doubling(skin(), incidence).totals.diffuse_reflectance);
  }
}

TEST(PatchPhotons, LeaveBelowAsWell) {
  const LayerStack slab({{.medium = {0.5, 20.0, 0.7, 1.4}, .thickness = 0.3}}, 1.0, 1.2);
  const Patch patch{
      .stack = slab, .columns = 2, .rows = 1, .texel = 200.0, .sigma_a = {{0.5, 3.0}}};
  const auto photons = trace_patch_photons(patch, {.photons = 60'000, .seed = 7});
  expect_within(photons.transmitted[0], adding_doubling(slab).totals.transmittance);
  EXPECT_LT(photons.transmitted[1].value, 0.6 * photons.transmitted[0].value);
}

TEST(PatchPhotons, FarFromTheEdgesOfStripesEachStripeIsItsOwnStack) {
  // Texels of 200 mm: light does not reach the next.
  Patch patch{.stack = skin(), .columns = 2, .rows = 1, .texel = 200.0};
  patch.sigma_a = {{}, {0.3, 2.0}};
  patch.irradiance = {1.0, 3.0};
  const auto photons = trace_patch_photons(patch, {.photons = 60'000, .seed = 4});
  const LayerStack dark({skin().layers()[0], {.medium = {2.0, 15.0, 0.8, 1.38}}}, 1.0, 1.38);
  expect_within(photons.exitance[0], adding_doubling(skin()).totals.diffuse_reflectance);
  expect_within(photons.exitance[1], 3.0 * adding_doubling(dark).totals.diffuse_reflectance);
}

TEST(PatchPhotons, CrossTexelsAlongObliquePaths) {
  // A clear plate on a denser base: down, one reflection, up. The mean over starts has no closed
  // form short of a sum, which is taken here with many starts.
  Patch patch{.stack = LayerStack({{.medium = {0.0, 0.0, 0.0, 1.5}, .thickness = 1.0}}, 1.5, 3.0),
              .columns = 4,
              .rows = 1,
              .texel = 0.3};
  const std::vector<double> sigma_a = {0.0, 2.0, 0.5, 1.0};
  patch.sigma_a = {sigma_a};
  const double theta = 0.7, slope = std::tan(theta), ds = 1.0 / std::cos(theta);
  double expected = 0.0;
  constexpr int starts = 300, steps = 3000;
  for (int i = 0; i < starts; ++i) {
    double tau = 0.0;
    for (int j = 0; j < steps; ++j) {
      const double x = (i + 0.5) / starts * 1.2 + 2.0 * slope * (j + 0.5) / steps;
      tau += sigma_a[std::size_t(x / 0.3) % 4] * 2.0 * ds / steps;
    }
    expected += fresnel(std::cos(theta), 2.0) * std::exp(-tau) / starts;
  }
  const auto photons =
      trace_patch_photons(patch, {.photons = 400'000, .seed = 5, .incidence = {.theta = theta}});
  expect_within(mean(photons.exitance), expected);
}

TEST(PatchPhotons, LoseLightAtEachCrossingOfAJunction) {
  const Layer clear{.medium = {0.0, 0.0, 0.0, 1.5}, .thickness = 1.0};
  Patch patch{.stack = LayerStack({clear, clear}, 1.5, 3.0), .columns = 2, .texel = 1.0};
  patch.junction = {{1.0, 0.5}};
  const auto photons = trace_patch_photons(patch, {.photons = 200'000, .seed = 6});
  expect_within(photons.exitance[0], fresnel(1.0, 2.0));
  expect_within(photons.exitance[1], 0.25 * fresnel(1.0, 2.0));
}

TEST(PatchPhotons, DoNotDependOnThreads) {
  Patch patch{.stack = skin(), .columns = 8, .rows = 8, .texel = 0.1};
  patch.irradiance = std::vector(64, 0.0);
  patch.irradiance[9] = 1.0;
  const PatchPhotonOptions options{.photons = 20'000, .seed = 7};
  const auto many = trace_patch_photons(patch, options);
  set_thread_count(1);
  const auto one = trace_patch_photons(patch, options);
  set_thread_count(0);
  for (std::size_t t = 0; t < 64; ++t) {
    EXPECT_EQ(many.exitance[t].value, one.exitance[t].value);
    EXPECT_EQ(many.exitance[t].standard_error, one.exitance[t].standard_error);
  }
  EXPECT_GT(many.exitance[9].value, many.exitance[10].value);  // light stays near
}

TEST(PatchPhotons, RefuseMapsThatDoNotFit) {
  const auto expect_refusal = [](const Patch& patch, const std::string& message) {
    try {
      (void)trace_patch_photons(patch, {.photons = 1});
      FAIL() << message;
    } catch (const InvalidInput& error) {
      EXPECT_EQ(error.what(), message);
    }
  };
  Patch patch{.stack = skin(), .columns = 2, .rows = 2};
  patch.sigma_a = {{1.0, 2.0}};
  expect_refusal(patch, "sigma_a must have 4 texels, but has 2");
  patch.sigma_a = {{1.0, 2.0, -1.0, 0.0}};
  expect_refusal(patch, "sigma_a must lie in [0, inf), but is -1");
  patch.sigma_a = {{1.0, 2.0, std::nan(""), 0.0}};
  expect_refusal(patch, "sigma_a must lie in [0, inf), but is nan");
  patch.sigma_a = {};
  patch.irradiance = std::vector(4, 0.0);
  expect_refusal(patch, "irradiance must not be 0 everywhere");
}

}  // namespace
}  // namespace lamina
