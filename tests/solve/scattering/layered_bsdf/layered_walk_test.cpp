// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/layered_bsdf/layered_walk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_bsdf.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();

Layer layer(double albedo, double thickness, double g, double ior, double sigma_t = 1.0) {
  return {.medium = {.sigma_a = sigma_t * (1.0 - albedo),
                     .sigma_s = sigma_t * albedo,
                     .g = g,
                     .ior = ior},
          .thickness = thickness};
}

/// Bands that differ in albedo, extinction and phase.
std::vector<std::vector<LayerStack>> cases() {
  std::vector<std::vector<LayerStack>> all(4);
  for (const double x : {1.0, 0.7, 0.3}) {
    all[0].push_back(LayerStack({layer(0.95 * x, infinite, 0.0, 1.0)}));
    all[1].push_back(LayerStack({layer(0.98, 2.0, 0.5 * x, 1.4, x)}));
    Layer mixed = layer(0.9, 0.4, 0.8, 1.34);
    mixed.medium.g = 0.56;
    mixed.phase = PhaseMixture{{{0.7, HenyeyGreenstein{0.8}}, {0.3, Rayleigh{}}}};
    all[2].push_back(LayerStack(
        {layer(0.9 * x, 0.3, 0.7, 1.5), mixed, layer(0.95, infinite, 0.3, 1.4)}, 1.0, 1.4));
    all[3].push_back(
        LayerStack({layer(0.9, 0.5, 0.6, 1.33, x)}, 1.0, 1.5, {.reflectance = 0.8 * x}));
  }
  return all;
}

Vec3 direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

TEST(LayeredWalk, ConvergesToTheBsdfOfAddingDoubling) {
  constexpr int walks = 20'000;
  const double theta_o = 0.6;
  const std::vector<double> theta_i{0.3, 1.3}, phi{0.0, pi};
  for (std::size_t c = 0; c < cases().size(); ++c) {
    const auto bands = cases()[c];
    const auto stack = make_first_order<4>(bands);
    const auto out = make_beam(stack, direction(theta_o, 0.0));
    const LayeredWalk<4> walk(stack, out);
    Random random(11);
    for (std::size_t i = 0; i < theta_i.size(); ++i)
      for (std::size_t j = 0; j < phi.size(); ++j) {
        const auto in = make_beam(stack, direction(theta_i[i], phi[j]));
        double sum[3] = {}, squares[3] = {};
        for (int k = 0; k < walks; ++k) {
          const auto value = walk.evaluate(in, random);
          for (int b = 0; b < 3; ++b) {
            const auto x = static_cast<double>(value[b]);
            sum[b] += x;
            squares[b] += x * x;
          }
        }
        for (int b = 0; b < 3; ++b) {
          // The same both ways, in air.
          const StackBsdf truth = stack_bsdf(bands[static_cast<std::size_t>(b)], theta_o, theta_i,
                                             phi, {.accuracy = 1e-4});
          const double expected = truth.brdf[i * phi.size() + (1 - j)];  // 0 is forward there
          const double mean = sum[b] / walks;
          const double error = std::sqrt((squares[b] / walks - mean * mean) / walks);
          EXPECT_NEAR(mean, expected, 4.0 * error + 2e-4 * expected)
              << "case " << c << " band " << b << " angles " << i << " " << j;
          EXPECT_LT(error, 0.02 * expected);
        }
      }
  }
}

TEST(LayeredWalk, LeavesWithTheFluxOfAddingDoubling) {
  constexpr int walks = 40'000;
  for (std::size_t c = 0; c < cases().size(); ++c) {
    const auto bands = cases()[c];
    const auto stack = make_first_order<4>(bands);
    const auto out = make_beam(stack, direction(0.6, 0.0));
    const LayeredWalk<4> walk(stack, out);
    Random random(5);
    double sum[3] = {}, squares[3] = {};
    for (int k = 0; k < walks; ++k) {
      const auto exit = walk.trace(random);
      for (int b = 0; b < 3; ++b) {
        const auto x = static_cast<double>(exit.weight[b]);
        sum[b] += x;
        squares[b] += x * x;
      }
    }
    for (int b = 0; b < 3; ++b) {
      const auto truth = adding_doubling(bands[static_cast<std::size_t>(b)], {.theta = 0.6});
      const double mean = sum[b] / walks;
      const double error = std::sqrt((squares[b] / walks - mean * mean) / walks);
      EXPECT_NEAR(mean,
                  truth.totals.diffuse_reflectance + truth.totals.specular_reflectance -
                      truth.unscattered_reflectance,
                  4.0 * error)
          << "case " << c << " band " << b;
      EXPECT_LT(error, 0.02 * mean);
    }
  }
}

}  // namespace
}  // namespace lamina
