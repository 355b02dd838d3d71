// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/adding_doubling_bsdf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/adding_doubling/internal/adding_doubling_lobes.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "literal/stack_table.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();

Layer layer(double sigma_a, double sigma_s, double g, double ior, double thickness) {
  return {.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
          .thickness = thickness};
}

/// Angles of a product rule over the hemisphere: cosines by Gauss, azimuths equal.
struct Hemisphere {
  static constexpr int phis = 32;
  Quadrature cosines = gauss_legendre(20, 0.0, 1.0);
  std::vector<double> theta, phi;

  Hemisphere() {
    for (const double cos : cosines.nodes) theta.push_back(std::acos(cos));
    for (int j = 0; j < phis; ++j) phi.push_back(2.0 * pi * (j + 0.5) / phis);
  }
  /// Flux per irradiance of radiance per irradiance.
  [[nodiscard]] double flux(const std::vector<double>& bsdf) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < bsdf.size(); ++k)
      sum += bsdf[k] * cosines.weights[k / phis] * cosines.nodes[k / phis] * 2.0 * pi / phis;
    return sum;
  }
};

// The totals know nothing of azimuth, of outgoing nodes or of the single scattering put in exactly.
TEST(StackBsdf, HemisphereHoldsTheTotals) {
  const Hemisphere hemisphere;
  for (const auto& [name, stack] : reference::stack_table()) {
    // A denser outside has a kink at the critical angle, which this rule cannot see.
    if (stack.ior_above() > 1.0 || stack.ior_below() > 1.4) continue;
    const double theta_i = 0.7;
    const StackBsdf bsdf = stack_bsdf(stack, theta_i, hemisphere.theta, hemisphere.phi,
                                      {.accuracy = 1e-2, .max_nodes = 24});
    const auto exact = adding_doubling(stack, {.theta = theta_i});
    const SlabTotals& totals = exact.totals;
    // 20 directions carry peaks of g = 0.95 to 3e-4 of their light, all others to 1e-5.
    EXPECT_NEAR(hemisphere.flux(bsdf.brdf) + bsdf.unscattered_reflectance,
                totals.specular_reflectance + totals.diffuse_reflectance, 5e-4)
        << name;
    EXPECT_NEAR(hemisphere.flux(bsdf.btdf) + bsdf.unscattered_transmittance, totals.transmittance,
                5e-4)
        << name;
  }
}

TEST(StackBsdf, LambertianGroundLooksTheSameFromEverywhere) {
  const LayerStack ground({layer(0.0, 0.0, 0.0, 1.0, 1.0)}, 1.0, 1.0, {.reflectance = 0.6});
  const StackBsdf bsdf =
      stack_bsdf(ground, 0.5, std::vector{0.0, 0.4, 1.4}, std::vector{0.0, 1.0, pi});
  for (const double value : bsdf.brdf) EXPECT_NEAR(value, 0.6 / pi, 1e-12);
}

// Isotropic half-space: f = W / (4 pi) H(mu_i) H(mu_o) / (mu_i + mu_o), [Chandrasekhar1960] §38.
TEST(StackBsdf, IsotropicHalfSpaceFollowsChandrasekhar) {
  const double albedo = 0.9;
  const Quadrature rule = gauss_legendre(60, 0.0, 1.0);
  std::vector<double> h(60, 1.0);
  const auto h_of = [&](double x) {
    double inverse = std::sqrt(1.0 - albedo);
    for (std::size_t i = 0; i < 60; ++i)
      inverse += 0.5 * albedo * rule.weights[i] * rule.nodes[i] * h[i] / (x + rule.nodes[i]);
    return 1.0 / inverse;
  };
  for (int pass = 0; pass < 200; ++pass) {
    std::vector<double> next;
    for (const double node : rule.nodes) next.push_back(h_of(node));
    h = next;
  }
  const LayerStack half_space({layer(1.0 - albedo, albedo, 0.0, 1.0, infinite)});
  const std::vector<double> thetas = {0.0, 0.6, 1.2, 1.5};
  for (const double theta_i : thetas) {
    const StackBsdf bsdf =
        stack_bsdf(half_space, theta_i, thetas, std::vector{0.3, 2.0}, {.accuracy = 1e-6});
    for (std::size_t i = 0; i < thetas.size(); ++i) {
      const double mu_i = std::cos(theta_i), mu_o = std::cos(thetas[i]);
      const double expected = albedo / (4.0 * pi) * h_of(mu_i) * h_of(mu_o) / (mu_i + mu_o);
      EXPECT_NEAR(bsdf.brdf[2 * i], expected, 1e-6 * expected);
      EXPECT_NEAR(bsdf.brdf[2 * i + 1], expected, 1e-6 * expected);
    }
  }
}

TEST(StackBsdf, IsReciprocal) {
  const std::vector<double> thetas = {0.2, 0.9, 1.4};
  const std::vector<double> phis = {0.0, 0.8, pi};
  for (const char* wanted : {"water slab, forward", "skin, red", "four mismatched layers"}) {
    for (const auto& [name, stack] : reference::stack_table()) {
      if (name != wanted) continue;
      std::vector<StackBsdf> from;
      for (const double theta : thetas)
        from.push_back(stack_bsdf(stack, theta, thetas, phis, {.accuracy = 1e-3}));
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < a; ++b)
          for (std::size_t j = 0; j < 3; ++j) {
            const double there = from[a].brdf[b * 3 + j], back = from[b].brdf[a * 3 + j];
            EXPECT_NEAR(there, back, 2e-3 * there) << name;
          }
    }
  }
}

// btdf(wi, wo) / n_o^2 is the same both ways.
TEST(StackBsdf, TransmitsReciprocally) {
  const LayerStack stack({layer(0.5, 4.0, 0.6, 1.4, 0.3), layer(0.1, 8.0, 0.3, 1.33, 0.1)}, 1.0,
                         1.2);
  const double above = 0.8, below = 1.1;
  const std::vector<double> phi = {0.5};
  const StackBsdfOptions options{.accuracy = 1e-5};
  const double down = stack_bsdf(stack, above, std::vector{below}, phi, options).btdf[0];
  const double up = stack_bsdf(flipped(stack), below, std::vector{above}, phi, options).btdf[0];
  EXPECT_NEAR(down / (1.2 * 1.2), up, 2e-5 * up);
}

// Down to the last angle below 90 degrees, for light and for eyes.
TEST(StackBsdf, GoesToItsLimitAtGrazingAngles) {
  for (const double ior : {1.0, 1.4}) {
    const LayerStack stack({layer(0.1, 10.0, 0.5, ior, 1.0)});
    const double grazing = std::nextafter(0.5 * pi, 0.0);
    const std::vector<double> theta_o = {0.3, 1.2, 0.5 * pi - 1e-6, grazing}, phi = {0.0, 2.0};
    const StackBsdf near = stack_bsdf(stack, 0.5 * pi - 1e-6, theta_o, phi);
    const StackBsdf at = stack_bsdf(stack, grazing, theta_o, phi);
    for (std::size_t i = 0; i < 4; ++i) {  // towards both angles that do not graze
      EXPECT_NEAR(at.brdf[i], near.brdf[i], 2e-5 * (1.0 + near.brdf[i])) << ior << ", " << i;
      EXPECT_NEAR(at.btdf[i], near.btdf[i], 2e-5 * (1.0 + near.btdf[i])) << ior << ", " << i;
      EXPECT_GE(at.brdf[i], 0.0);
    }
    for (std::size_t i = 4; i < 8; ++i) {
      EXPECT_TRUE(std::isfinite(at.brdf[i]) && std::isfinite(at.btdf[i])) << ior << ", " << i;
    }
  }
}

// So thin that light scatters once: the closed form of [HanrahanKrueger1993] with its errata, here
// matched. Forward peak of g = 0.9, 100 times the mean: no ringing, no negative values.
TEST(StackBsdf, ThinSlabIsThePhaseFunction) {
  const double tau = 1e-4, theta_i = 0.6;
  const LayerStack thin({layer(0.0, 1.0, 0.9, 1.0, tau)});
  const std::vector<double> thetas = {0.0, 0.3, 0.61, 1.2}, phis = {0.0, 1.0, 2.5, pi};
  const StackBsdf bsdf = stack_bsdf(thin, theta_i, thetas, phis);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      const double mu_i = std::cos(theta_i), mu_o = std::cos(thetas[i]);
      const double across = std::sin(theta_i) * std::sin(thetas[i]) * std::cos(phis[j]);
      const auto expected = [&](double cos_theta) {
        return evaluate(HenyeyGreenstein{0.9}, cos_theta) * tau / (mu_i * mu_o);
      };
      EXPECT_NEAR(bsdf.brdf[i * 4 + j], expected(-mu_i * mu_o + across),
                  3e-3 * expected(-mu_i * mu_o + across));  // next order: tau / mu, with a peak
      EXPECT_NEAR(bsdf.btdf[i * 4 + j], expected(mu_i * mu_o + across),
                  3e-3 * expected(mu_i * mu_o + across));
    }
}

// The forward peak is reflected at the lower face and seen from above in the mirror direction.
TEST(StackBsdf, SeesThePeakReflectedInside) {
  const LayerStack slab({layer(0.0, 1.0, 0.95, 1.5, 0.2)});
  const StackBsdf bsdf = stack_bsdf(slab, 0.7, std::vector{0.7}, std::vector{0.0, pi});
  EXPECT_GT(bsdf.brdf[0], 20.0 * bsdf.brdf[1]);
}

/// Means over cells of equal solid angle, [cosine][azimuth from forward, over 180
/// degrees], by a product rule in each cell, weighted as flux is.
struct Cells {
  static constexpr int rows = 3, columns = 4, points = 2;
  Quadrature rule = gauss_legendre(points, 0.0, 1.0);
  std::vector<double> theta, phi;

  Cells() {
    for (int k = 0; k < rows; ++k)
      for (const double x : rule.nodes) theta.push_back(std::acos((k + x) / rows));
    for (int k = 0; k < columns; ++k)
      for (const double x : rule.nodes) phi.push_back(pi * (k + x) / columns);
  }
  [[nodiscard]] double mean(const std::vector<double>& bsdf, int row, int column) const {
    double sum = 0.0, all = 0.0;
    for (std::size_t i = 0; i < points; ++i)
      for (std::size_t j = 0; j < points; ++j) {
        const std::size_t a = static_cast<std::size_t>(row) * points + i;
        const std::size_t b = static_cast<std::size_t>(column) * points + j;
        const double weight = std::cos(theta[a]) * rule.weights[i] * rule.weights[j];
        sum += weight * bsdf[a * phi.size() + b];
        all += weight;
      }
    return sum / all;
  }
};

// Photons walk from facet to facet one by one, and know neither grids nor modes.
void agree_with_photons(const LayerStack& stack) {
  const Cells cells;
  const double theta_i = 0.9;
  const StackBsdf exact =
      stack_bsdf(stack, theta_i, cells.theta, cells.phi, {.accuracy = 0.02, .max_nodes = 10});
  const MonteCarloResult photons = trace_photons(
      stack, {.photons = 60'000,
              .seed = 5,
              .incidence = {.theta = theta_i},
              .tallies = {.bsdf_cosines = Cells::rows, .bsdf_azimuths = 2 * Cells::columns}});
  double chi_square = 0.0;
  int count = 0;
  for (const bool is_above : {true, false})
    for (int i = 0; i < Cells::rows; ++i)
      for (int j = 0; j < Cells::columns; ++j) {
        const auto& tally = is_above ? photons.bsdf.reflection : photons.bsdf.transmission;
        const auto first = static_cast<std::size_t>(2 * Cells::columns * i);
        const Estimate& left = tally[first + static_cast<std::size_t>(j)];
        const Estimate& right = tally[first + static_cast<std::size_t>(2 * Cells::columns - 1 - j)];
        const double value = cells.mean(is_above ? exact.brdf : exact.btdf, i, j);
        const double error = 0.5 * std::hypot(left.standard_error, right.standard_error);
        const double deviation = (0.5 * (left.value + right.value) - value) / error;
        EXPECT_LT(std::abs(deviation), 4.5) << is_above << " " << i << " " << j << " " << value;
        chi_square += deviation * deviation;
        ++count;
      }
  EXPECT_LT(std::abs(chi_square - count), 4.0 * std::sqrt(2.0 * count)) << chi_square;
}

TEST(RoughStackBsdf, RoughTopAgreesWithPhotons) {
  Layer paint = layer(0.5, 9.0, 0.5, 1.5, 0.3);
  paint.top = {.roughness = 0.4};
  agree_with_photons(LayerStack({paint}));
}

TEST(RoughStackBsdf, RoughBottomAgreesWithPhotons) {
  const Interface ggx{.roughness = 0.5, .distribution = MicrofacetDistribution::ggx};
  agree_with_photons(LayerStack({layer(0.5, 9.0, 0.5, 1.5, 0.3)}, 1.0, 1.0, {.top = ggx}));
}

// What meets one facet has a closed form; all else must come back as it went.
TEST(RoughStackBsdf, IsReciprocal) {
  Layer glass = layer(0.3, 4.0, 0.6, 1.5, 0.3);
  glass.top = {.roughness = 0.5};
  const LayerStack stack({glass});
  const std::vector<double> thetas{0.4, 1.2}, phis{0.0, 1.0, pi};
  const StackBsdfOptions options{.accuracy = 0.02, .max_nodes = 10};
  const StackBsdf from_first = stack_bsdf(stack, thetas[0], thetas, phis, options);
  const StackBsdf from_second = stack_bsdf(stack, thetas[1], thetas, phis, options);
  const StackBsdf from_below = stack_bsdf(flipped(stack), thetas[1], thetas, phis, options);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_NEAR(from_first.brdf[3 + j], from_second.brdf[j], 0.02 * from_second.brdf[j]);
    EXPECT_NEAR(from_first.btdf[3 + j], from_below.btdf[j], 0.02 * from_below.btdf[j]);
  }
}

// A frosted plate needs its lobes resolved; paint scatters in between, and needs nothing.
TEST(RoughStackBsdf, RefusesLobesTooNarrowForIt) {
  Layer glass = layer(0.0, 0.0, 0.0, 1.5, 1.0);
  glass.top.roughness = 0.02;
  const std::vector<double> theta{0.5}, phi{0.0};
  try {
    (void)stack_bsdf(LayerStack({glass}), 0.5, theta, phi);
    FAIL() << "values of lobes that no grid resolves";
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(),
                 "layer 0: the lobes of roughness 0.02 need 150 directions and 300 azimuthal "
                 "modes, but adding-doubling takes at most 42 directions; photon Monte Carlo takes "
                 "them");
  }
  Layer paint = layer(1.0, 20.0, 0.0, 1.5, 1.0);
  paint.top.roughness = 0.02;
  EXPECT_EQ(detail::narrowest_lobe(LayerStack({paint})).nodes, 0);
}

TEST(StackBsdf, RefusesWhatItCannotDo) {
  const LayerStack slab({layer(1.0, 9.0, 0.75, 1.0, 0.2)});
  const std::vector<double> good = {0.1}, bad = {0.5 * pi};
  EXPECT_THROW((void)stack_bsdf(slab, bad[0], good, good), InvalidInput);
  EXPECT_THROW((void)stack_bsdf(slab, 0.1, bad, good), InvalidInput);
  EXPECT_THROW((void)stack_bsdf(slab, 0.1, good, std::vector{std::nan("")}), InvalidInput);
  EXPECT_THROW((void)stack_bsdf(slab, 0.1, good, good, {.accuracy = 0.0}), InvalidInput);
}

}  // namespace
}  // namespace lamina
