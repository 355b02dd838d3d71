// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// The fit on what it is for: layers from their totals, by adding-doubling.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "lamina/skin/fit/least_squares/nonlinear_fit.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

/// R, T and T unscattered of a slab of 1 mm between slides of glass.
std::vector<double> totals(double sigma_a, double sigma_s_prime, double g, double thickness = 1.0) {
  const Layer glass{.medium = {.ior = 1.5}, .thickness = 1.0};
  const Layer sample{
      .medium = {.sigma_a = sigma_a, .sigma_s = sigma_s_prime / (1.0 - g), .g = g, .ior = 1.37},
      .thickness = thickness};
  const AddingDoublingTotals found =
      adding_doubling(LayerStack({glass, sample, glass}), {}, {.accuracy = 1e-8});
  return {found.totals.specular_reflectance + found.totals.diffuse_reflectance,
          found.totals.transmittance, found.unscattered_transmittance};
}

FitParameter positive(const std::string& name, double start) {
  return {.name = name, .start = start, .low = 1e-6, .high = 1e4, .scale = FitScale::logarithmic};
}

// Numbers without noise come back: sigma_a, sigma_s (1 - g) and g within 1e-4 of themselves.
TEST(SlabFit, ThreeTotalsTellThreeCoefficients) {
  for (const auto& [sigma_a, sigma_s_prime, g] :
       std::vector<std::array<double, 3>>{{0.05, 1.0, 0.8}, {0.6, 0.5, 0.3}, {0.002, 0.8, 0.0}}) {
    const FitModel model{.predict = [](std::span<const double> p) {
      std::vector<double> predicted = totals(p[0], p[1], p[2]);
      predicted[2] = std::log(predicted[2]);
      return predicted;
    }};
    const std::vector<double> truth = {sigma_a, sigma_s_prime, g};
    const FitResult result = fit_parameters(
        {positive("sigma_a", 0.1),
         positive("sigma_s_prime", 1.0),
         {.name = "g", .start = 0.5, .low = -0.99, .high = 0.99, .scale = FitScale::logit}},
        {.measured = model.predict(truth), .standard_deviation = {1e-4, 1e-4, 1e-4}}, model);
    EXPECT_TRUE(result.has_converged);
    EXPECT_NEAR(result.parameters[0].value / sigma_a, 1.0, 1e-4);
    EXPECT_NEAR(result.parameters[1].value / sigma_s_prime, 1.0, 1e-4);
    EXPECT_NEAR(result.parameters[2].value, g, 1e-4);
  }
}

// Totals stay if every coefficient grows as lengths shrink: no spectrum of uniform light tells them
// apart, and the fit says so.
TEST(SlabFit, SeesThatTotalsHaveNoLength) {
  const FitModel model{
      .predict = [](std::span<const double> p) { return totals(p[0], p[1], 0.8, p[2]); }};
  const FitResult result = fit_parameters(
      {positive("sigma_a", 0.1), positive("sigma_s_prime", 1.0), positive("thickness", 0.8)},
      {.measured = totals(0.05, 1.0, 0.8), .standard_deviation = {1e-3, 1e-3, 1e-3}}, model,
      {.step = 1e-3});
  ASSERT_EQ(result.notes.size(), 1U);
  EXPECT_EQ(result.notes[0],
            "sigma_a and sigma_s_prime divided and thickness multiplied by any one factor give "
            "the same prediction: the data cannot tell the scale");
}

}  // namespace
}  // namespace lamina
