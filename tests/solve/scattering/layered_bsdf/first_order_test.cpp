// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/layered_bsdf/first_order.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/layers/optics/fresnel.h"
#include "literal/first_order_cases.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;

Vec3 direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// tools/tables/first_order_table.cpp has more photons.
TEST(FirstOrder, PhotonsScatteredOnceLeaveAsTheFormulasSay) {
  double chi2 = 0.0;
  int cells = 0;
  for (const auto& one : reference::first_order_cases()) {
    const auto found = reference::compare_first_order(one, 1'000'000);
    EXPECT_LT(found.worst, 4.0) << one.name;
    EXPECT_LT(found.worst_flux, 4.0) << one.name;
    EXPECT_LT(found.relative_error, 0.06) << one.name;  // so that noise hides no bias
    chi2 += found.chi2;
    cells += found.cells;
  }
  EXPECT_NEAR(chi2, cells, 4.0 * std::sqrt(2.0 * cells));
}

// f / ior_out^2 is symmetric: same side and, with the factor n^2, from one side to the other.
TEST(FirstOrder, LightRetracesItsPath) {
  for (const auto& [name, layers, theta_i] : reference::first_order_cases())
    for (const auto reflections : {InternalReflections::lost, InternalReflections::summed}) {
      const auto stack = make_first_order(layers, reflections);
      const auto bands = make_first_order<8>({&layers, 1}, reflections);
      const Vec3 wi = direction(theta_i, 0.0);
      for (const double theta_o : {0.0, 0.5, 1.2, 1.55, 1.6, 2.5, pi}) {
        if (std::cos(theta_o) < 0.0 && !stack.is_transmissive()) continue;
        const Vec3 wo = direction(theta_o, 2.0);
        const auto in = make_beam(stack, wi), out = make_beam(stack, wo);
        const double there = first_order_bsdf(stack, in, out) / (out.ior * out.ior);
        const double back = first_order_bsdf(stack, out, in) / (in.ior * in.ior);
        EXPECT_NEAR(there, back, 1e-14 * there) << name << " " << theta_o;
        const auto in8 = make_beam(bands, wi), out8 = make_beam(bands, wo);
        const float there8 = first_order_bsdf(bands, in8, out8)[3] / (out8.ior[3] * out8.ior[3]);
        const float back8 = first_order_bsdf(bands, out8, in8)[3] / (in8.ior[3] * in8.ior[3]);
        EXPECT_NEAR(there8, back8, 1e-6f * there8) << name << " " << theta_o;
        EXPECT_NEAR(static_cast<double>(there8), there, 2e-5 * there) << name << " " << theta_o;
      }
    }
}

// [HanrahanKrueger1993] Eq. 12 with the angles of physics: one slab, written out by hand.
TEST(FirstOrder, OneSlabFollowsTheClosedForm) {
  const double n = 1.33, W = 0.8, g = 0.5, tau = 0.7, theta_i = 0.7, theta_o = 1.0, phi = 0.8;
  const LayerStack slab(
      {{.medium = {.sigma_a = 2.0 * (1.0 - W), .sigma_s = 2.0 * W, .g = g, .ior = n},
        .thickness = 0.5 * tau}});
  const auto stack = make_first_order(slab, InternalReflections::lost);
  const double mu_i = cos_refracted(std::cos(theta_i), n),
               mu_o = cos_refracted(std::cos(theta_o), n);
  const double sines = std::sin(theta_i) * std::sin(theta_o) / (n * n) * std::cos(phi);
  const double transmitted =
      (1.0 - fresnel(std::cos(theta_i), n)) * (1.0 - fresnel(std::cos(theta_o), n));
  const Vec3 wo = direction(theta_o, pi - phi);  // phi from forward
  const auto in = make_beam(stack, direction(theta_i, 0.0));
  const double p_back = evaluate(HenyeyGreenstein{g}, sines - mu_i * mu_o);
  EXPECT_NEAR(first_order_bsdf(stack, in, make_beam(stack, wo)),
              transmitted / (n * n) * W * p_back / (mu_i + mu_o) *
                  (1.0 - std::exp(-tau * (1.0 / mu_i + 1.0 / mu_o))),
              1e-13);
  const double p_on = evaluate(HenyeyGreenstein{g}, sines + mu_i * mu_o);
  EXPECT_NEAR(first_order_bsdf(stack, in, make_beam(stack, {wo.x, wo.y, -wo.z})),
              transmitted / (n * n) * W * p_on / (mu_i - mu_o) *
                  (std::exp(-tau / mu_i) - std::exp(-tau / mu_o)),
              1e-13);
}

// At equal angles and near them: l'Hospital's limit W p tau / mu^2 exp(-tau / mu) / ..., and no
// noise of cancelled digits on the way there.
TEST(FirstOrder, TransmissionIsSmoothWhereTheAnglesAgree) {
  const double W = 0.6, tau = 2.0, theta = 0.6, mu = std::cos(theta);
  const LayerStack slab({{.medium = {.sigma_a = 1.0 - W, .sigma_s = W}, .thickness = tau}});
  const auto stack = make_first_order(slab);
  const auto bands = make_first_order<4>({&slab, 1});
  const double limit = W / (4.0 * pi) * tau / (mu * mu) * std::exp(-tau / mu);
  for (const double offset : {0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4}) {
    const Vec3 wi = direction(theta, 0.0), wo = direction(pi - theta - offset, 1.0);
    EXPECT_NEAR(first_order_bsdf(stack, make_beam(stack, wi), make_beam(stack, wo)), limit,
                limit * (2.0 * offset + 1e-13));
    EXPECT_NEAR(first_order_bsdf(bands, make_beam(bands, wi), make_beam(bands, wo))[0], limit,
                limit * (2.0 * offset + 2e-6));
  }
}

// Isotropic, matched: (W / 2) (1 - mu ln(1 + 1 / mu)), the first term of Chandrasekhar's albedo.
TEST(FirstOrder, HalfSpaceReturnsTheKnownFlux) {
  const double W = 0.7;
  const LayerStack half_space({{.medium = {.sigma_a = 1.0 - W, .sigma_s = W}}});
  const auto stack = make_first_order(half_space);
  for (const double mu : {0.01, 0.3, 0.8, 1.0}) {
    const auto in = make_beam(stack, direction(std::acos(mu), 0.0));
    EXPECT_NEAR(first_order_flux(stack, in, true), 0.5 * W * (1.0 - mu * std::log(1.0 + 1.0 / mu)),
                1e-6)
        << mu;
    // Seeliger's law is its angle.
    const auto out = make_beam(stack, direction(0.4, 2.0));
    EXPECT_NEAR(first_order_bsdf(stack, in, out), W / (4.0 * pi) / (mu + std::cos(0.4)), 1e-12);
  }
}

TEST(FirstOrder, ThinMatchedLayersScatterAllThatTheyTake) {
  const LayerStack thin({{.medium = {.sigma_s = 1e-6, .g = 0.9}, .thickness = 1.0}});
  const auto stack = make_first_order(thin);
  for (const double theta : {0.0, 0.8, 1.4}) {
    const auto in = make_beam(stack, direction(theta, 0.0));
    const double taken = 1.0 - in.reflected - in.ground;
    EXPECT_NEAR(taken, 1e-6 / std::cos(theta), 1e-10);
    EXPECT_NEAR(first_order_flux(stack, in, true) + first_order_flux(stack, in, false), taken,
                1e-3 * taken);
  }
}

TEST(FirstOrder, ClearPlateReflectsAllOrdersOfInterreflections) {
  const LayerStack plate({{.medium = {.ior = 1.5}, .thickness = 1.0}});
  for (const double theta : {0.0, 0.8, 1.4}) {
    const double f = fresnel(std::cos(theta), 1.5);
    const auto beam = make_beam(make_first_order(plate), direction(theta, 0.0));
    EXPECT_NEAR(beam.reflected, 2.0 * f / (1.0 + f), 1e-12);
    EXPECT_NEAR(beam.ground, 1.0 - beam.reflected, 1e-12);
  }
}

TEST(FirstOrder, FluxIsTheIntegralOfTheBsdf) {
  for (const auto& [name, layers, theta_i] : reference::first_order_cases()) {
    if (layers.ior_below() > 1.4) continue;  // a kink at the critical angle, lost on this rule
    const auto stack = make_first_order(layers);
    const auto in = make_beam(stack, direction(theta_i, 0.0));
    for (const bool is_above : {true, false}) {
      if (!is_above && !stack.is_transmissive()) continue;
      double sum = 0.0;
      constexpr int azimuths = 64;
      const Quadrature mus = gauss_legendre(48, 0.0, 1.0);
      for (std::size_t i = 0; i < mus.nodes.size(); ++i)
        for (int j = 0; j < azimuths; ++j) {
          const double theta = std::acos(is_above ? mus.nodes[i] : -mus.nodes[i]);
          const auto out = make_beam(stack, direction(theta, 2.0 * pi * j / azimuths));
          sum += mus.weights[i] * mus.nodes[i] * 2.0 * pi / azimuths *
                 first_order_bsdf(stack, in, out);
        }
      EXPECT_NEAR(first_order_flux(stack, in, is_above), sum, 1e-4) << name << " " << is_above;
    }
  }
}

// A pool: what its bottom sends back is weakened on the way down and up, and spread by n^2.
TEST(FirstOrder, PoolBottomIsSeenThroughWater) {
  const double n = 1.33, tau = 0.3, rho = 0.5;
  const LayerStack pool({{.medium = {.sigma_a = tau, .ior = n}, .thickness = 1.0}}, 1.0, n,
                        {.reflectance = rho});
  const auto stack = make_first_order(pool, InternalReflections::lost);
  const auto crossing = [&](double theta) {
    return (1.0 - fresnel(std::cos(theta), n)) * std::exp(-tau / cos_refracted(std::cos(theta), n));
  };
  const auto in = make_beam(stack, direction(0.5, 0.0)),
             out = make_beam(stack, direction(1.0, 2.0));
  EXPECT_NEAR(first_order_bsdf(stack, in, out), crossing(0.5) * crossing(1.0) * rho / pi / (n * n),
              1e-14);
}

// A mirror at the bottom: an index so high that the boundary reflects nearly all.
TEST(FirstOrder, MirrorBelowSendsBackWhatTheLayerLeft) {
  const LayerStack layers({{.medium = {.sigma_a = 0.4}, .thickness = 1.0}}, 1.0, 1e6);
  const auto beam = make_beam(make_first_order(layers), direction(0.6, 0.0));
  EXPECT_NEAR(beam.reflected, std::exp(-2.0 * 0.4 / std::cos(0.6)), 1e-4);
}

TEST(FirstOrder, RoughBoundariesInsideAreRefused) {
  const Layer smooth{.medium = {.sigma_s = 1.0}, .thickness = 1.0};
  Layer rough = smooth;
  rough.top.roughness = 0.3;
  EXPECT_NO_THROW(make_first_order(LayerStack({rough, smooth})));
  try {
    (void)make_first_order(LayerStack({smooth, rough}));
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("layer 1"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace lamina
