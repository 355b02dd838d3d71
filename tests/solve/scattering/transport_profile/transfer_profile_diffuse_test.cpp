// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/low_orders/diffuse_single_scattering.h"
#include "lamina/solve/scattering/low_orders/single_at_contact.h"
#include "lamina/solve/scattering/low_orders/unscattered_paths.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "lamina/solve/scattering/transport_profile/spatial_frequency_response.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"
#include "literal/diffuse_single_rays.h"
#include "literal/stack_table.h"

namespace lamina {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

Layer layer(double sigma_a, double sigma_s, double g, double ior, double thickness) {
  return {.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
          .thickness = thickness};
}

detail::FrequencyResponse diffuse_response(const detail::FrequencySolver& solver, double k) {
  return detail::diffuse_responses(solver, {&k, 1}).front();
}

// No wave: adding-doubling's totals for diffuse light.
TEST(DiffuseResponse, IsTheTotalAtZeroFrequency) {
  for (const char* name : {"skin, red", "glass slab", "Giovanelli half-space", "denser below"}) {
    const auto solver = detail::make_frequency_solver(reference::find_stack(name), 8, 1);
    const auto wave = diffuse_response(solver, 0.0);
    const auto totals =
        adding_doubling(reference::find_stack(name), {.is_diffuse = true}, {.max_nodes = 8}).totals;
    EXPECT_NEAR(wave.reflectance, totals.diffuse_reflectance, 1e-10) << name;
    EXPECT_NEAR(wave.transmittance, totals.transmittance, 1e-10) << name;
  }
}

// What passes from above to below passes back: transmittance over the index squared of the side
// lit.
TEST(DiffuseResponse, IsReciprocal) {
  for (const char* name : {"on glass", "denser below", "lighter on denser", "air gap"}) {
    const LayerStack& stack = reference::find_stack(name);
    const auto down = detail::make_frequency_solver(stack, 5, 5);
    const auto up = detail::make_frequency_solver(flipped(stack), 5, 5);
    for (const double k : {0.0, 2.0, 30.0})
      EXPECT_NEAR(diffuse_response(down, k).transmittance * std::pow(stack.ior_above(), 2),
                  diffuse_response(up, k).transmittance * std::pow(stack.ior_below(), 2), 1e-12)
          << name << ", k " << k;
  }
}

// If there are few scatterers, twice as many make twice the difference: all of first order is taken
// out at every frequency.
TEST(DiffuseSingle, LeavesHigherOrdersOnly) {
  for (const double k : {0.0, 3.0, 50.0}) {
    const auto rest = [&](double sigma_s) {
      const LayerStack stack(
          {layer(2.0, sigma_s, 0.4, 1.0, 0.1), layer(1.0, 2.0 * sigma_s, 0.0, 1.0, 0.2)});
      const auto solver = detail::make_frequency_solver(stack, 5, 3);
      const auto all = diffuse_response(solver, k);
      const auto none =
          detail::unscattered_response(solver, detail::unscattered_paths(solver.stack), k);
      const auto once = detail::diffuse_single_on_grid(solver, k);
      return std::pair{all.reflectance - none.reflectance - once.reflectance,
                       all.transmittance - none.transmittance - once.transmittance};
    };
    const auto few = rest(1e-3), many = rest(2e-3);
    EXPECT_NEAR(many.first / few.first, 4.0, 0.02) << "k " << k;
    EXPECT_NEAR(many.second / few.second, 4.0, 0.02) << "k " << k;
  }
}

// Bessel functions in the place of azimuths.
TEST(DiffuseSingle, IsTheLimitOfFineGrids) {
  for (const char* name : {"skin, red", "glass slab"}) {
    const auto fine = detail::make_frequency_solver(reference::find_stack(name), 24, 41);
    std::vector<double> extinction;
    for (const detail::GridLayer& l : fine.stack.layers) extinction.push_back(l.sigma_t);
    const auto exact = detail::single_response(detail::make_diffuse_single(fine, extinction), 5.0);
    const auto solver = detail::make_frequency_solver(reference::find_stack(name), 12, 11);
    const auto on_grid = detail::diffuse_single_on_grid(solver, 5.0);
    EXPECT_NEAR(on_grid.reflectance / exact.reflectance, 1.0, 2e-4) << name;
    if (exact.transmittance > 0.0) {
      EXPECT_NEAR(on_grid.transmittance / exact.transmittance, 1.0, 2e-4) << name;
    }
  }
}

// Rays over radius in the place of waves.
TEST(DiffuseSingle, IsTheTransformOfItsRays) {
  const LayerStack& stack = reference::find_stack("glass slab");
  const auto fine = detail::make_frequency_solver(stack, 24, 41);
  const auto wave = detail::single_response(
      detail::make_diffuse_single(fine, {fine.stack.layers[0].sigma_t}), 5.0);
  // Light that leaves stays within 41.8 degrees of the normal, and with that within a distance.
  const double widest = stack.layers()[0].thickness * std::tan(std::asin(1.0 / 1.5));
  constexpr double nearest = 1e-4;
  const auto over_rays = [&](double detail::SingleScatteringProfile::*side, double last) {
    double sum = 0.0;
    const Quadrature log_r = gauss_legendre(20, std::log(nearest), std::log(last));
    for (std::size_t i = 0; i < log_r.nodes.size(); ++i) {
      const double r = std::exp(log_r.nodes[i]);
      sum += log_r.weights[i] * 2.0 * std::numbers::pi * r * r * std::cyl_bessel_j(0.0, 5.0 * r) *
             (detail::single_rays::profile_at(stack, fine.stack, fine.top, r).*side);
    }
    return sum;
  };
  const double reflected = nearest * detail::single_at_contact(stack, fine.stack, fine.top) +
                           over_rays(&detail::SingleScatteringProfile::reflectance, 2.0 * widest);
  const double transmitted = over_rays(&detail::SingleScatteringProfile::transmittance, widest);
  EXPECT_NEAR(reflected / wave.reflectance, 1.0, 5e-3);
  EXPECT_NEAR(transmitted / wave.transmittance, 1.0, 5e-3);
}

// Between equal indices isotropic light has a closed form: every depth sends sigma_s / 2 over r.
TEST(DiffuseSingle, GrowsAsItsClosedFormAtContact) {
  for (const double sigma_s : {1.0, 5.0}) {
    const LayerStack stack({layer(3.0, sigma_s, 0.0, 1.33, infinite)}, 1.33, 1.33);
    const auto solver = detail::make_frequency_solver(stack, 8, 1);
    EXPECT_NEAR(detail::single_at_contact(stack, solver.stack, solver.top), 0.5 * sigma_s,
                1e-4 * sigma_s);
  }
}

// Rings hold the flux of the directions that end in them, straight or after two reflections inside;
// a ring in which the light ends has what is left.
TEST(UnscatteredProfile, RingsHoldTheFluxBetweenRadii) {
  const LayerStack& stack = reference::find_stack("glass slab");
  const auto solver = detail::make_frequency_solver(stack, 8, 1);
  const auto paths = detail::unscattered_paths(solver.stack);
  const double d = stack.layers()[0].thickness, ior = stack.layers()[0].medium.ior;
  const double end = d * std::tan(std::asin(1.0 / ior));
  const Quadrature rule = gauss_legendre(64, 0.0, 1.0);
  const auto flux = [&](double from, double to) {
    double sum = 0.0;
    for (const int ways : {1, 3}) {
      const auto sine_at = [&](double r) {
        return std::min(1.0, ior * std::sin(std::atan(r / (ways * d))));
      };
      const double low = std::asin(sine_at(from)), high = std::asin(sine_at(to));
      for (std::size_t q = 0; q < rule.nodes.size(); ++q) {
        const double angle = low + (high - low) * rule.nodes[q];
        const double mirrored = fresnel(std::cos(angle), ior);
        const double cos_inside = std::sqrt(1.0 - std::pow(std::sin(angle) / ior, 2));
        sum += rule.weights[q] * (high - low) * std::sin(2.0 * angle) *
               std::pow(1.0 - mirrored, 2) * std::pow(mirrored, ways - 1) *
               std::exp(-ways * solver.stack.layers[0].sigma_t * d / cos_inside);
      }
    }
    return sum;
  };
  for (const auto& [from, to] : {std::pair{0.3 * end, 0.5 * end}, std::pair{0.95 * end, 1.1 * end}})
    EXPECT_NEAR(detail::unscattered_ring(solver, paths, from, to).transmittance * std::numbers::pi *
                    (to * to - from * from) / flux(from, to),
                1.0, 1e-3);
}

TEST(DiffuseProfile, RingsAddUpToTheTotal) {
  const std::vector<LayerStack> bands = {reference::find_stack("skin, red"),
                                         reference::find_stack("Giovanelli half-space")};
  const TransferProfile exact = transfer_profile(bands, {.first = 1e-4, .last = 50.0, .size = 200},
                                                 {.illumination = Illumination::diffuse});
  EXPECT_TRUE(exact.is_accurate);
  for (std::size_t band = 0; band < bands.size(); ++band) {
    const double total = exact.profile.total_reflectance[band];
    const FluxCurve flux = reflected_flux(exact.profile, band);
    EXPECT_NEAR((flux.within.back() + flux.beyond) / total, 1.0, 1e-3);
    EXPECT_NEAR(
        adding_doubling(bands[band], {.is_diffuse = true}, {}).totals.diffuse_reflectance / total,
        1.0, 1e-4);
  }
}

// Rings of 0.02 mm by photons, which come in at all angles and leave unscattered, too.
TEST(DiffuseProfile, AgreesWithMonteCarloRingByRing) {
  constexpr double ring = 0.02;
  constexpr std::size_t rings = 20;
  const std::vector<LayerStack> stacks = {
      reference::find_stack("Giovanelli half-space"),
      LayerStack({layer(1.0, 20.0, 0.6, 1.3, 0.05), layer(0.5, 8.0, 0.0, 1.5, 0.1)}, 1.33)};
  for (std::size_t band = 0; band < stacks.size(); ++band)
    for (const bool is_from_below : {false, true}) {
      const bool is_slab = !is_semi_infinite(stacks[band]);
      if (is_from_below && !is_slab) continue;
      MonteCarloOptions options{.photons = 300'000, .seed = 3, .incidence = {.is_diffuse = true}};
      options.tallies.r = {.count = rings, .width = ring};
      const MonteCarloResult photons =
          trace_photons(is_from_below ? flipped(stacks[band]) : stacks[band], options);
      const TransferProfile exact =
          transfer_profile(std::span(&stacks[band], 1), {.first = 1e-3, .last = 20.0, .size = 500},
                           {.accuracy = 0.02,
                            .r_highest = ring * rings,
                            .illumination = Illumination::diffuse,
                            .is_from_below = is_from_below});
      // Radii lie close, for what is not scattered ends at the critical angle.
      const Quadrature rule = gauss_legendre(8, 0.0, 1.0);
      for (const bool is_reflectance : {true, false}) {
        if (!is_reflectance && !is_slab) continue;
        double chi2 = 0.0;
        // What the top mirrors is in the first ring, all light beyond in the last.
        for (std::size_t i = 1; i + 1 < rings; ++i) {
          const double inner = static_cast<double>(i) * ring;
          double mean = 0.0;
          for (std::size_t q = 0; q < 8; ++q) {
            const double r = inner + ring * rule.nodes[q];
            mean += rule.weights[q] * 2.0 * r / (2.0 * inner + ring) *
                    (is_reflectance ? reflectance_profile(exact.profile, r, 0)
                                    : transmittance_profile(exact.profile, r, 0));
          }
          const Estimate& estimate =
              (is_reflectance ? photons.radial.reflection : photons.radial.transmission)[i];
          const double sigma = std::hypot(estimate.standard_error, 0.01 * mean);
          chi2 += std::pow((estimate.value - mean) / sigma, 2);
          EXPECT_NEAR(estimate.value, mean, 4.5 * sigma)
              << "stack " << band << ", reflectance " << is_reflectance << ", ring " << i;
        }
        EXPECT_LT(chi2 / (rings - 2), 1.8)
            << "stack " << band << ", from below " << is_from_below << ", reflectance "
            << is_reflectance << ", estimate " << exact.estimated_error[0];
      }
    }
}

TEST(TransferProfile, DoesNotDependOnThreads) {
  const std::vector<LayerStack> bands = {reference::find_stack("glass slab"),
                                         reference::find_stack("skin, red")};
  for (const Illumination illumination : {Illumination::normal_beam, Illumination::diffuse}) {
    const auto solved = [&](int threads) {
      set_thread_count(threads);
      const TransferProfile exact =
          transfer_profile(bands, {.first = 1e-2, .last = 10.0, .size = 30},
                           {.accuracy = 0.05, .illumination = illumination});
      set_thread_count(0);
      return exact;
    };
    const TransferProfile one = solved(1), three = solved(3);
    EXPECT_EQ(one.profile.reflectance_profile, three.profile.reflectance_profile);
    EXPECT_EQ(one.profile.transmittance_profile, three.profile.transmittance_profile);
    EXPECT_EQ(one.profile.total_reflectance, three.profile.total_reflectance);
    EXPECT_EQ(one.relative_error, three.relative_error);
  }
}

TEST(TransferProfile, RefusesLightFromBelowWhereThereIsNone) {
  const std::vector<LayerStack> endless = {reference::find_stack("Giovanelli half-space")};
  EXPECT_THROW((void)transfer_profile(endless, {}, {.is_from_below = true}), InvalidInput);
  const std::vector<LayerStack> on_ground = {
      LayerStack({layer(1.0, 9.0, 0.0, 1.4, 1.0)}, 1.0, 1.0, {.reflectance = 0.5})};
  EXPECT_THROW((void)transfer_profile(on_ground, {}, {.is_from_below = true}), InvalidInput);
  EXPECT_THROW((void)spatial_frequency_response(endless, std::vector{1.0}, {.is_from_below = true}),
               InvalidInput);
}

}  // namespace
}  // namespace lamina
