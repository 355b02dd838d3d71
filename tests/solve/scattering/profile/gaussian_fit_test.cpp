// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/profile/gaussian_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"
#include "lamina/solve/scattering/transport_profile/gaussian_profile.h"
#include "literal/diffusion_skin.h"

namespace lamina {
namespace {

TEST(GaussianFit, FindsTheWeightsThatASpectrumWasMadeOf) {
  const GaussianSum made = {.variances = {1e-3, 1e-2, 0.1, 1.0}, .weights = {0.2, 0.0, 0.4, 0.1}};
  const std::vector<double> k = fit_frequencies(made.variances);
  std::vector<double> spectrum;
  for (const double at : k) spectrum.push_back(evaluate_at_frequency(made, at));
  const GaussianFit fit = fit_gaussians(spectrum, k, made.variances);
  EXPECT_TRUE(fit.converged);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(fit.sum.weights[i], made.weights[i], 1e-10);
  EXPECT_LT(fit.largest_error, 1e-12);
}

// The conditions of Karush, Kuhn and Tucker: at the best fit no weight that is 0 wants to grow, and
// those that are not stand where the error is stationary.
TEST(GaussianFit, NoChangeOfWeightsThatAreNotNegativeFitsBetter) {
  const std::vector<double> variances = doubling_variances(), k = fit_frequencies(variances);
  std::vector<double> spectrum;  // falls faster than Gaussians can follow: some weights are bound
  for (const double at : k) spectrum.push_back(1.0 / std::pow(1.0 + 0.01 * at * at, 4));
  const GaussianFit fit = fit_gaussians(spectrum, k, variances);
  ASSERT_TRUE(fit.converged);
  for (std::size_t i = 0; i < variances.size(); ++i) {
    double gradient = 0.0;
    for (std::size_t j = 0; j < k.size(); ++j)
      gradient += std::exp(-0.5 * k[j] * k[j] * variances[i]) *
                  (evaluate_at_frequency(fit.sum, k[j]) - spectrum[j]);
    EXPECT_GE(fit.sum.weights[i], 0.0);
    EXPECT_GT(gradient, -1e-10);
    if (fit.sum.weights[i] > 0.0) {
      EXPECT_NEAR(gradient, 0.0, 1e-10);
    }
  }
}

TEST(GaussianFit, FollowsTheReflectanceOfSkinWithinOnePercent) {
  const std::vector<double> variances = doubling_variances(), k = fit_frequencies(variances);
  for (const LayerStack& skin : reference::donner_jensen_skin()) {
    const LayeredDiffusion model = make_layered_diffusion(skin);
    std::vector<double> spectrum;
    for (const double at : k) spectrum.push_back(response(model, at).reflection_above);
    const GaussianFit fit = fit_gaussians(spectrum, k, variances);
    EXPECT_TRUE(fit.converged);
    EXPECT_LT(fit.largest_error, 0.01);
    EXPECT_LT(fit.rms_error, 0.005);
    EXPECT_LE(fit.rms_error, fit.largest_error);
    // Between the fitted frequencies the error is no larger.
    for (std::size_t j = 1; j + 1 < k.size(); ++j) {
      const double between = std::sqrt(k[j] * k[j + 1]);
      EXPECT_NEAR(evaluate_at_frequency(fit.sum, between),
                  response(model, between).reflection_above, 1.5 * fit.largest_error * spectrum[0]);
    }
  }
}

TEST(GaussianFit, RadiusAndFrequencyAreTransformsOfEachOther) {
  const GaussianSum sum = {.variances = {0.01, 0.3}, .weights = {0.5, 0.25}};
  for (const double k : {0.0, 1.0, 7.0})
    EXPECT_NEAR(
        integrate(
            [&](double r) { return 2.0 * std::numbers::pi * r * ::j0(k * r) * evaluate(sum, r); },
            0.0, 6.0, 1e-12),
        evaluate_at_frequency(sum, k), 1e-10);
}

TEST(GaussianFit, VariancesDoubleFromTheFirst) {
  const std::vector<double> variances = doubling_variances();
  ASSERT_EQ(variances.size(), 19u);
  EXPECT_EQ(variances[0], 0.0);
  EXPECT_EQ(variances[1], 1e-4);
  EXPECT_DOUBLE_EQ(variances[18], 1e-4 * 131072.0);
}

TEST(GaussianFit, NothingIsFittedByNothing) {
  const std::vector<double> k = {0.0, 1.0, 2.0}, none(3, 0.0), variances = {0.0, 1.0};
  const GaussianFit fit = fit_gaussians(none, k, variances);
  EXPECT_TRUE(fit.converged);
  EXPECT_EQ(fit.sum.weights, std::vector<double>(2, 0.0));
  EXPECT_EQ(fit.largest_error, 0.0);
}

// Fitted where the solver works; over radius it must be the exact profile, as far as the fit says.
TEST(GaussianProfile, IsTheTransferProfile) {
  const std::vector<LayerStack> bands = {
      LayerStack(
          {{.medium = {.sigma_a = 0.2, .sigma_s = 10.0, .g = 0.0, .ior = 1.3}, .thickness = 0.5}}),
      LayerStack(
          {{.medium = {.sigma_a = 2.0, .sigma_s = 10.0, .g = 0.0, .ior = 1.3}, .thickness = 0.5}})};
  const GaussianProfile fit = fit_gaussian_profile(bands, 10);
  const TransferProfile exact = transfer_profile(bands, {.first = 0.1, .last = 1.0, .size = 5});
  ASSERT_EQ(fit.variances.size(), 11u);
  ASSERT_EQ(fit.transmittance.size(), 2u);
  for (std::size_t b = 0; b < 2; ++b) {
    EXPECT_LT(fit.reflectance[b].rms_error, 0.02) << b;
    EXPECT_GT(fit.reflectance[b].rms_error, 0.0) << b;
    double total = 0.0;
    for (const double weight : fit.reflectance[b].sum.weights) total += weight;
    EXPECT_NEAR(total / exact.profile.total_reflectance[b], 1.0,
                2.0 * fit.reflectance[b].largest_error + 0.002)
        << b;
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(
          evaluate(fit.reflectance[b].sum, exact.profile.r[i]) / exact.profile.reflectance_at(i, b),
          1.0, 0.15)
          << b << ", r " << exact.profile.r[i];
  }
}

}  // namespace
}  // namespace lamina
