// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/adding_doubling_rough.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "lamina/layers/optics/rough/multiple_scattering.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "literal/stack_table.h"

namespace lamina {
namespace {

constexpr auto beckmann = MicrofacetDistribution::beckmann;
constexpr auto ggx = MicrofacetDistribution::ggx;

Layer layer(double sigma_a, double sigma_s, double g, double ior, double thickness,
            Interface top = {}) {
  return {.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
          .thickness = thickness,
          .top = top};
}

Incidence oblique(double degrees) { return {.theta = degrees * std::numbers::pi / 180.0}; }

double sum(const SlabTotals& totals) {
  return totals.specular_reflectance + totals.diffuse_reflectance + totals.transmittance +
         std::accumulate(totals.absorptance.begin(), totals.absorptance.end(), 0.0);
}

TEST(RoughAddingDoubling, KeepsItsEnergy) {
  const Interface rough{.roughness = 0.6, .distribution = ggx};
  const LayerStack stack({layer(0.0, 5.0, 0.5, 1.5, 0.4, rough), layer(0.0, 0.0, 0.0, 1.3, 0.1),
                          layer(0.5, 5.0, 0.5, 1.6, 0.4, rough)},
                         1.2, 1.0, {.top = {.roughness = 0.2}, .reflectance = 0.4});
  for (const Incidence& incidence : {Incidence{}, oblique(75.0), Incidence{.is_diffuse = true}}) {
    const SlabTotals totals = adding_doubling(stack, incidence, {.accuracy = 0.01}).totals;
    EXPECT_NEAR(sum(totals), 1.0, 1e-9);
    EXPECT_NEAR(totals.absorptance[0], 0.0, 1e-9);
    EXPECT_NEAR(totals.absorptance[1], 0.0, 1e-9);
  }
}

TEST(RoughAddingDoubling, BarelyRoughIsAsSmooth) {
  for (const double ior : {0.75, 1.5})
    for (const double degrees : {0.0, 40.0}) {
      const auto totals = [&](double roughness) {
        return adding_doubling(
                   LayerStack({layer(0.5, 10.0, 0.5, ior, 0.3, {.roughness = roughness})}),
                   oblique(degrees), {.accuracy = 1e-4})
            .totals;
      };
      const SlabTotals smooth = totals(0.0), rough = totals(2e-3);
      EXPECT_NEAR(rough.specular_reflectance, smooth.specular_reflectance, 1e-4) << ior;
      EXPECT_NEAR(rough.diffuse_reflectance, smooth.diffuse_reflectance, 1e-4) << ior;
      EXPECT_NEAR(rough.transmittance, smooth.transmittance, 1e-4) << ior;
    }
}

/// Etendue-weighted mean of f(p) M g(p).
double bilinear(const DirectionGrid& grid, const detail::Matrix& m,
                const std::function<double(double)>& f, const std::function<double(double)>& g) {
  double total = 0.0;
  for (std::size_t j = 0; j < m.columns; ++j)
    for (std::size_t i = 0; i < m.rows; ++i)
      total += std::sqrt(grid.etendue[i] * grid.etendue[j]) * f(grid.p[i]) * m(i, j) * g(grid.p[j]);
  return total;
}

// Light on its way back: in flux over root etendue, which holds the square of the index.
TEST(RoughBoundary, IsReciprocal) {
  const auto f = [](double p) { return 1.0 + p; };
  const auto g = [](double p) { return std::cos(2.0 * p); };
  const std::vector<double> indices{1.0, 1.4};
  const DirectionGrid grid = make_direction_grid(indices, 16);
  for (const auto distribution : {beckmann, ggx})
    for (const int m : {0, 2}) {
      const auto made = detail::rough_boundary_modes(grid, {0.4, distribution}, 1.0, 1.4, m, 1)[0];
      EXPECT_NEAR(bilinear(grid, made.reflection_above, f, g),
                  bilinear(grid, made.reflection_above, g, f), 5e-4);
      EXPECT_NEAR(bilinear(grid, made.reflection_below, f, g),
                  bilinear(grid, made.reflection_below, g, f), 5e-4);
      EXPECT_NEAR(bilinear(grid, made.transmission_down, f, g),
                  bilinear(grid, made.transmission_up, g, f), 5e-4);
    }
}

// The same walk between facets, photon by photon: flux, mean cosine and mean of what turns.
TEST(RoughBoundary, SendsLightWhereWalksBetweenFacetsGo) {
  constexpr int walks = 40'000;
  const std::vector<double> indices{1.0, 1.5};
  for (const bool from_below : {false, true})
    for (const Interface& boundary : {Interface{0.5, beckmann}, Interface{0.9, ggx}}) {
      const DirectionGrid grid = make_direction_grid(indices, 16);
      const double ior = from_below ? 1.5 : 1.0, beyond = from_below ? 1.0 : 1.5;
      const std::size_t node = from_below ? 20 : 9;
      const double mu = cosine(grid, node, ior);
      const auto rough = make_rough_interface<double>(boundary, ior, beyond);
      double reflected = 0.0, cos_reflected = 0.0, cos_through = 0.0, turned = 0.0;
      Random random = make_random(5, 0);
      const Vec3 wi{std::sqrt(1.0 - mu * mu), 0.0, mu};
      for (int k = 0; k < walks; ++k) {
        const Vec3 wo = sample_multiple_scattering(rough, wi, random).wo;
        if (wo.z > 0.0) {
          reflected += 1.0 / walks;
          cos_reflected += wo.z / walks;
          turned += -wo.x / std::hypot(wo.x, wo.y) / walks;  // cosine from the azimuth of travel
        } else {
          cos_through -= wo.z / walks;
        }
      }
      const auto flux = [&](const detail::Matrix& m, double index, bool by_cosine) {
        double total = 0.0;
        for (std::size_t i = 0; i < m.rows; ++i)
          total += m(i, node) * std::sqrt(grid.etendue[i] / grid.etendue[node]) *
                   (by_cosine ? cosine(grid, i, index) : 1.0);
        return total;
      };
      const auto modes = detail::rough_boundary_modes(grid, boundary, 1.0, 1.5, 0, 2);
      const auto &mode0 = modes[0], &mode1 = modes[1];
      const auto& back = from_below ? mode0.reflection_below : mode0.reflection_above;
      const auto& through = from_below ? mode0.transmission_up : mode0.transmission_down;
      constexpr double four_errors = 4.0 * 0.5 / 200.0;  // of a fraction, at most
      EXPECT_NEAR(flux(back, ior, false), reflected, four_errors);
      EXPECT_NEAR(flux(through, beyond, false), 1.0 - reflected, four_errors);
      EXPECT_NEAR(flux(back, ior, true), cos_reflected, four_errors);
      EXPECT_NEAR(flux(through, beyond, true), cos_through, four_errors);
      const auto& turning = from_below ? mode1.reflection_below : mode1.reflection_above;
      EXPECT_NEAR(flux(turning, ior, false), turned, four_errors);
    }
}

TEST(RoughAddingDoubling, AgreesWithPhotons) {
  std::uint64_t seed = 1;
  for (const reference::StackCase& entry : reference::rough_stack_table()) {
    const Incidence incidence = oblique(seed % 2 == 0 ? 60.0 : 0.0);
    const SlabTotals exact = adding_doubling(entry.stack, incidence, {.accuracy = 1e-3}).totals;
    const MonteCarloResult photons =
        trace_photons(entry.stack, {.photons = 30'000, .seed = seed++, .incidence = incidence});
    const auto agree = [&](double value, const Estimate& estimate) {
      EXPECT_NEAR(value, estimate.value, 4.0 * estimate.standard_error + 2e-6) << entry.name;
    };
    agree(exact.specular_reflectance, photons.specular_reflectance);
    agree(exact.diffuse_reflectance, photons.diffuse_reflectance);
    agree(exact.transmittance, photons.transmittance);
    for (std::size_t k = 0; k < exact.absorptance.size(); ++k)
      agree(exact.absorptance[k], photons.absorptance[k]);
  }
}

// One solution of the boundary serves all bands.
TEST(RoughAddingDoubling, BandsThatShareTheirBoundariesAreAsAlone) {
  const Interface rough{.roughness = 0.4};
  const std::vector<LayerStack> bands{LayerStack({layer(0.5, 10.0, 0.5, 1.5, 0.3, rough)}),
                                      LayerStack({layer(2.0, 3.0, 0.8, 1.5, 0.3, rough)}),
                                      LayerStack({layer(2.0, 3.0, 0.8, 1.4, 0.3, rough)})};
  EXPECT_EQ(detail::groups_of_equal_boundaries(bands).size(), 2u);
  const AddingDoublingOptions options{.accuracy = 1e-2};
  const auto together = adding_doubling(bands, oblique(40.0), options);
  for (std::size_t b = 0; b < bands.size(); ++b) {
    const auto alone = adding_doubling(bands[b], oblique(40.0), options);
    EXPECT_EQ(together[b].totals.diffuse_reflectance, alone.totals.diffuse_reflectance);
    EXPECT_EQ(together[b].totals.transmittance, alone.totals.transmittance);
    EXPECT_EQ(together[b].nodes, alone.nodes);
  }
}

TEST(RoughAddingDoubling, SaysHowFarItCanBeTrusted) {
  const auto result =
      adding_doubling(LayerStack({layer(0.5, 10.0, 0.5, 1.5, 0.3, {.roughness = 0.3})}));
  EXPECT_FALSE(result.is_accurate);  // 1e-5 were asked for
  EXPECT_EQ(result.estimated_error, detail::rough_boundary_error);
  EXPECT_EQ(result.unscattered_transmittance, 0.0);
}

}  // namespace
}  // namespace lamina
