// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/layered_bsdf/higher_orders.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/layered_bsdf/layered_bsdf.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();

Layer layer(double albedo, double tau, double g, double ior) {
  return {.medium = {.sigma_a = 1.0 - albedo, .sigma_s = albedo, .g = g, .ior = ior},
          .thickness = tau};
}

const std::vector<LayerStack>& stacks() {
  static const std::vector<LayerStack> all = {
      LayerStack({layer(0.8, infinite, 0.0, 1.0)}),
      LayerStack({layer(0.95, 0.5, 0.5, 1.4), layer(0.9, infinite, 0.8, 1.34)}, 1.0, 1.34),
      LayerStack({layer(0.9, 5.0, 0.3, 1.33)}),
      LayerStack({layer(0.5, 0.3, 0.9, 1.5), layer(0.99, 2.0, 0.0, 1.33)}, 1.0, 1.2),
      LayerStack({layer(0.9, 0.4, 0.6, 1.33)}, 1.0, 1.33, {.reflectance = 0.7}),
  };
  return all;
}

Vec3 direction(double mu, double phi) {
  const double sine = std::sqrt(1.0 - mu * mu);
  return {sine * std::cos(phi), sine * std::sin(phi), mu};
}

// What the two parts of the model send to a side is what adding-doubling sends there.
TEST(HigherOrders, FluxesAreThoseOfAddingDoubling) {
  const Quadrature rule = gauss_legendre(64, 0.0, 1.0);
  for (std::size_t s = 0; s < stacks().size(); ++s) {
    const LayerStack& stack = stacks()[s];
    const auto first = make_first_order(stack);
    const HigherOrders higher = make_higher_orders(stack);
    for (const double theta : {0.0, 0.7, 1.35, 1.5}) {
      const auto in = make_beam(first, direction(std::cos(theta), 0.0));
      const auto flux = [&](double side) {
        double sum = first_order_flux(first, in, side > 0.0);
        for (std::size_t i = 0; i < rule.nodes.size(); ++i)
          sum += rule.weights[i] * 2.0 * pi * rule.nodes[i] *
                 higher_orders_bsdf(higher, in,
                                    make_beam(first, direction(side * rule.nodes[i], 0.0)));
        return sum;
      };
      const auto truth = adding_doubling(stack, {.theta = theta});
      const SlabTotals& totals = truth.totals;
      EXPECT_NEAR(
          flux(1.0),
          totals.diffuse_reflectance + totals.specular_reflectance - truth.unscattered_reflectance,
          1e-3)
          << "stack " << s << " at " << theta;
      if (!first.is_transmissive()) continue;
      EXPECT_NEAR(flux(-1.0), totals.transmittance - truth.unscattered_transmittance, 1e-3)
          << "stack " << s << " at " << theta;
    }
  }
}

TEST(HigherOrders, LightRetracesItsPath) {
  for (const LayerStack& stack : stacks()) {
    const auto first = make_first_order(stack);
    const HigherOrders higher = make_higher_orders(stack);
    const auto in = make_beam(first, direction(0.6, 0.0));
    for (const double mu : {1.0, 0.3, 0.01, -0.4, -0.9}) {
      if (mu < 0.0 && !first.is_transmissive()) continue;
      const auto out = make_beam(first, direction(mu, 2.0));
      const double there = higher_orders_bsdf(higher, in, out) / (out.ior * out.ior);
      EXPECT_NEAR(higher_orders_bsdf(higher, out, in) / (in.ior * in.ior), there, 1e-14);
      EXPECT_GT(there, 0.0);
    }
  }
}

// [HanrahanKrueger1993] Figure 9: half-space, matched, isotropic, 45 degrees.
TEST(HigherOrders, TermWithoutShapeIsCloseForIsotropicScattering) {
  std::vector<double> theta, phi;
  for (int i = 0; i < 45; ++i) theta.push_back(2.0 * i * pi / 180.0);
  for (int j = 0; j <= 18; ++j) phi.push_back(10.0 * j * pi / 180.0);
  for (const double W : {0.4, 0.8}) {
    const LayerStack half_space({layer(W, infinite, 0.0, 1.0)});
    const auto model = layered_bsdf(half_space, ScatteringOrders::all, pi / 4, theta, phi);
    const auto first = layered_bsdf(half_space, ScatteringOrders::first, pi / 4, theta, phi);
    const auto truth = stack_bsdf(half_space, pi / 4, theta, phi);
    EXPECT_LT(misplaced_light(model.brdf, truth.brdf, theta, phi), 0.008) << W;
    EXPECT_GT(misplaced_light(first.brdf, truth.brdf, theta, phi), 0.2) << W;
    EXPECT_EQ(misplaced_light(truth.brdf, truth.brdf, theta, phi), 0.0);
  }
}

TEST(HigherOrders, RoughBoundariesInsideAreRefused) {
  Layer rough = layer(0.5, 1.0, 0.0, 1.3);
  rough.top.roughness = 0.3;
  EXPECT_NO_THROW((void)make_higher_orders(LayerStack({rough})));
  EXPECT_THROW((void)make_higher_orders(LayerStack({layer(0.5, 1.0, 0.0, 1.4), rough})),
               InvalidInput);
}

}  // namespace
}  // namespace lamina
