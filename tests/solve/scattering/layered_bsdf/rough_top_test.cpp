// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Stacks under a rough top by the layered BSDF: f = R f_s + (1 - R) f_v, [HanrahanKrueger1993] §2.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/layered_bsdf/layered_bsdf.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();

Layer layer(double albedo, double tau, double g, double ior, double roughness = 0.0) {
  return {.medium = {.sigma_a = 1.0 - albedo, .sigma_s = albedo, .g = g, .ior = ior},
          .thickness = tau,
          .top = {.roughness = roughness}};
}

LayerStack half_space(double roughness, double albedo = 0.8) {
  return LayerStack({layer(albedo, infinite, 0.5, 1.4, roughness)}, 1.0, 1.4);
}

LayerStack slab(double roughness, double albedo = 0.8) {
  return LayerStack({layer(albedo, 0.5, 0.6, 1.33, roughness)});
}

/// Flux into cells of equal solid angle on each side, [side][cosine][azimuth in halves of pi].
struct CellFluxes {
  static constexpr int cosines = 6, azimuths = 2;
  std::vector<double> reflection, transmission;
};

CellFluxes fluxes_of_photons(const LayerStack& stack, double theta_i, bool is_first) {
  constexpr int all = 2 * CellFluxes::azimuths;
  const MonteCarloResult traced = trace_photons(
      stack,
      {.photons = 500'000,
       .seed = 3,
       .incidence = {.theta = theta_i},
       .tallies = {.bsdf_cosines = CellFluxes::cosines, .bsdf_azimuths = all, .orders = true}});
  const auto flux = [&](const std::vector<Estimate>& every, const std::vector<Estimate>& by_order) {
    std::vector<double> cells;
    for (int i = 0; i < CellFluxes::cosines; ++i)
      for (int j = 0; j < CellFluxes::azimuths; ++j) {
        const auto value = [&](int column) {
          const auto cell = static_cast<std::size_t>(i * all + column);
          constexpr std::size_t plane = CellFluxes::cosines * all;
          return is_first ? by_order[cell].value + by_order[plane + cell].value : every[cell].value;
        };
        const double mid = (i + 0.5) / CellFluxes::cosines;
        cells.push_back(0.5 * (value(j) + value(all - 1 - j)) * mid * pi /
                        (CellFluxes::cosines * CellFluxes::azimuths));
      }
    return cells;
  };
  return {flux(traced.bsdf.reflection, traced.bsdf_by_order.reflection),
          flux(traced.bsdf.transmission, traced.bsdf_by_order.transmission)};
}

CellFluxes fluxes_of_model(const LayerStack& stack, double theta_i, ScatteringOrders orders) {
  constexpr int points = 8;
  std::vector<double> theta, phi, weight, phi_weight;
  for (int i = 0; i < CellFluxes::cosines; ++i) {
    const Quadrature rule = gauss_legendre(points, double(i) / CellFluxes::cosines,
                                           double(i + 1) / CellFluxes::cosines);
    for (std::size_t q = 0; q < rule.nodes.size(); ++q) {
      theta.push_back(std::acos(rule.nodes[q]));
      weight.push_back(rule.weights[q] * rule.nodes[q]);
    }
  }
  for (int j = 0; j < CellFluxes::azimuths; ++j) {
    const Quadrature rule =
        gauss_legendre(points, pi * j / CellFluxes::azimuths, pi * (j + 1) / CellFluxes::azimuths);
    phi.insert(phi.end(), rule.nodes.begin(), rule.nodes.end());
    phi_weight.insert(phi_weight.end(), rule.weights.begin(), rule.weights.end());
  }
  const StackBsdf bsdf = layered_bsdf(stack, orders, theta_i, theta, phi);
  const auto flux = [&](const std::vector<double>& values) {
    std::vector<double> cells(CellFluxes::cosines * CellFluxes::azimuths, 0.0);
    for (std::size_t i = 0; i < theta.size(); ++i)
      for (std::size_t j = 0; j < phi.size(); ++j)
        cells[(i / points) * CellFluxes::azimuths + j / points] +=
            weight[i] * phi_weight[j] * values[i * phi.size() + j];
    return cells;
  };
  return {flux(bsdf.brdf), flux(bsdf.btdf)};
}

double sum_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum;
}

/// Sum of |a - b| over that of b.
double misplaced(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += std::abs(a[k] - b[k]);
  return sum / sum_of(b);
}

// Photons meet each facet by themselves; unscattered light that met facets is of order 0. Cells
// have noise of a percent. Light that several facets reflect is a few percent of what comes back
// and has no shape here; at roughness 1 the mirror inside the slab should not keep angles.
TEST(RoughTop, FirstOrderIsThatOfPhotons) {
  struct Case {
    std::string name;
    LayerStack stack;
    double reflected, transmitted;  ///< allowed share of the light in other cells
  };
  const double theta = pi / 4;
  for (const Case& c :
       {Case{"half-space .3", half_space(0.3), 0.03, 0.0},
        Case{"half-space 1", half_space(1.0), 0.04, 0.0}, Case{"slab .3", slab(0.3), 0.03, 0.015},
        Case{"slab 1", slab(1.0), 0.05, 0.05}}) {
    const CellFluxes photons = fluxes_of_photons(c.stack, theta, true);
    const CellFluxes model = fluxes_of_model(c.stack, theta, ScatteringOrders::first);
    EXPECT_LT(misplaced(model.reflection, photons.reflection), c.reflected) << c.name;
    if (sum_of(photons.transmission) > 0.0) {
      EXPECT_LT(misplaced(model.transmission, photons.transmission), c.transmitted) << c.name;
    }
  }
}

// What the first order has too much, where the top sends back inside, no other order can take away.
TEST(RoughTop, FluxesOfAllOrdersAreThoseOfAddingDoubling) {
  struct Case {
    LayerStack stack;
    double theta, tolerance;
  };
  for (const Case& c : {Case{half_space(0.4), 1.1, 0.001}, Case{half_space(1.0), 0.0, 0.001},
                        Case{slab(0.4), 0.3, 0.002}, Case{slab(1.0), 1.1, 0.006}}) {
    const SlabTotals truth = adding_doubling(c.stack, {.theta = c.theta}).totals;
    const CellFluxes model = fluxes_of_model(c.stack, c.theta, ScatteringOrders::all);
    EXPECT_NEAR(2.0 * sum_of(model.reflection),
                truth.diffuse_reflectance + truth.specular_reflectance, c.tolerance);
    EXPECT_NEAR(2.0 * sum_of(model.transmission), truth.transmittance, c.tolerance);
  }
}

TEST(RoughTop, WhiteMediumSendsAllLightBack) {
  const CellFluxes thick = fluxes_of_model(half_space(1.0, 1.0), 0.5, ScatteringOrders::all);
  EXPECT_NEAR(2.0 * sum_of(thick.reflection), 1.0, 0.002);
  const CellFluxes thin = fluxes_of_model(slab(0.4, 1.0), 0.5, ScatteringOrders::all);
  EXPECT_NEAR(2.0 * (sum_of(thin.reflection) + sum_of(thin.transmission)), 1.0, 0.002);
}

// Beside the mirror direction nothing is left of the facets. Tables have 129 cosines, and rough
// operators are good to 1e-4.
TEST(RoughTop, HardlyRoughIsSmooth) {
  const std::vector<double> theta{0.1, 0.4, 1.2}, phi{0.0, 1.0, 3.0};
  for (const auto make : {half_space, slab}) {
    const StackBsdf rough =
        layered_bsdf(make(0.002, 0.8), ScatteringOrders::all, pi / 4, theta, phi);
    const StackBsdf smooth =
        layered_bsdf(make(0.0, 0.8), ScatteringOrders::all, pi / 4, theta, phi);
    for (std::size_t k = 0; k < smooth.brdf.size(); ++k) {
      EXPECT_NEAR(rough.brdf[k], smooth.brdf[k], 4e-3 * smooth.brdf[k]) << k;
      EXPECT_NEAR(rough.btdf[k], smooth.btdf[k], 4e-3 * smooth.btdf[k]) << k;
    }
  }
}

TEST(RoughTop, LightRetracesItsPath) {
  const double a = 0.3, b = 1.2;
  for (const LayerStack& stack : {half_space(0.4), slab(0.4)}) {
    const std::vector<double> phi{0.7};
    const auto value = [&](double from, double to) {
      return layered_bsdf(stack, ScatteringOrders::first, from, std::vector{to}, phi).brdf[0];
    };
    EXPECT_NEAR(value(a, b), value(b, a), 3e-3 * value(a, b));
  }
}

}  // namespace
}  // namespace lamina
