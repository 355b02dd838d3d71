// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/low_orders/single_scattering_profile.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_spectrum.h"
#include "lamina/solve/scattering/transport_profile/internal/transfer_profile_cost.h"
#include "lamina/solve/scattering/transport_profile/spatial_frequency_response.h"
#include "literal/spectral_reflection.h"
#include "literal/stack_table.h"

namespace lamina {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

Layer layer(double sigma_a, double sigma_s, double g, double ior, double thickness) {
  return {.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
          .thickness = thickness};
}

/// Integral of 2 pi r f(r) w(r) over all r, in log r.
template <class F>
double over_plane(const F& f) {
  const auto ring = [&](double log_r) {
    const double r = std::exp(log_r);
    return 2.0 * std::numbers::pi * r * r * f(r);
  };
  return integrate(ring, std::log(1e-10), std::log(1e3), 1e-8);
}

// No wave: the diffuse totals of adding-doubling on the same grid.
TEST(FrequencyResponse, IsTheTotalAtZeroFrequency) {
  for (const char* name : {"skin, red", "skin, blue", "glass slab", "Giovanelli half-space",
                           "denser below", "thin isotropic", "high index"}) {
    const auto solver = detail::make_frequency_solver(reference::find_stack(name), 8, 3);
    const auto wave = detail::response(solver, 0.0);
    const auto same_grid = adding_doubling(reference::find_stack(name), {}, {.max_nodes = 8});
    const SlabTotals& totals = same_grid.totals;
    EXPECT_NEAR(wave.reflectance,
                totals.specular_reflectance + totals.diffuse_reflectance -
                    same_grid.unscattered_reflectance,
                1e-10)
        << name;
    EXPECT_NEAR(wave.transmittance, totals.transmittance - same_grid.unscattered_transmittance,
                1e-10)
        << name;
  }
}

// Light retraces its way between all directions and azimuthal modes, oblique beams among them. Two
// beams alone, both of no width, do not see one another.
TEST(FrequencyResponse, IsReciprocal) {
  for (const char* name : {"skin, red", "denser below", "on glass", "air gap"}) {
    const LayerStack& stack = reference::find_stack(name);
    const auto solver = detail::make_frequency_solver(
        stack, 5, 5,
        std::array{direction_in(stack.ior_above(), 0.3), direction_in(stack.ior_above(), 0.9)});
    const auto& etendue = solver.stack.grid.etendue;
    for (const double k : {0.0, 2.0, 50.0}) {
      const auto reflection = reference::spectral_reflection(solver, k);
      double largest = 0.0;  // difference of what leaves per solid angle
      for (std::size_t a = 0; a < reflection.mode.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) {
          const double e_a = etendue[reflection.node[a]], e_b = etendue[reflection.node[b]];
          if (std::max(e_a, e_b) == extra_node_etendue) continue;
          const bool is_odd = (reflection.mode[a] + reflection.mode[b]) % 2 == 1;
          const double back = (is_odd ? -1.0 : 1.0) * reflection.matrix(b, a);
          largest =
              std::max(largest, std::abs(reflection.matrix(a, b) - back) / std::sqrt(e_a * e_b));
        }
      EXPECT_LT(largest, 1e-12) << name << ", k " << k;
    }
  }
}

TEST(FrequencyResponse, CuttingALayerChangesNothing) {
  const LayerStack whole({layer(0.5, 10.0, 0.6, 1.4, 0.5)});
  const LayerStack cut({layer(0.5, 10.0, 0.6, 1.4, 0.1), layer(0.5, 10.0, 0.6, 1.4, 0.4)});
  const auto a = detail::make_frequency_solver(whole, 6, 5);
  const auto b = detail::make_frequency_solver(cut, 6, 5);
  for (const double k : {0.1, 3.0, 40.0}) {
    EXPECT_NEAR(detail::response(a, k).reflectance, detail::response(b, k).reflectance, 1e-11);
    EXPECT_NEAR(detail::response(a, k).transmittance, detail::response(b, k).transmittance, 1e-11);
  }
}

// A clear plate between shifts each direction sideways: the coupled modes must do so too. Witness:
// a plate that scatters so little that it does not count, and goes another way through the code.
TEST(FrequencyResponse, ClearLayerIsTheLimitOfAThinScatterer) {
  const LayerStack clear({layer(0.0, 0.0, 0.0, 1.0, 0.1), layer(1.0, 9.0, 0.0, 1.0, infinite)});
  const LayerStack faint({layer(0.0, 1e-9, 0.0, 1.0, 0.1), layer(1.0, 9.0, 0.0, 1.0, infinite)});
  const auto a = detail::make_frequency_solver(clear, 6, 5);
  const auto b = detail::make_frequency_solver(faint, 6, 5);
  for (const double k : {0.0, 1.0, 10.0})
    EXPECT_NEAR(detail::response(a, k).reflectance, detail::response(b, k).reflectance, 1e-9);
}

// With all modes f_0 = J0, f_m = sqrt(2) J_m. The end of a short chain must not be heard.
TEST(AzimuthWaves, AreBesselFunctionsWhereLightIsLeft) {
  for (const auto& [modes, tolerance] : {std::pair{3, 6e-3}, {5, 1e-3}, {7, 3e-4}, {11, 3e-5}}) {
    const auto waves = detail::azimuth_waves(detail::make_azimuth_chain(modes));
    for (double c = 0.0; c < 60.0; c += 0.25)
      for (int m = 0; m <= 2; ++m) {
        double sum = 0.0;
        for (std::size_t q = 0; q < waves.rate.size(); ++q)
          sum +=
              (waves.weight[static_cast<std::size_t>(m)][q] * std::exp(waves.rate[q] * c)).real();
        const double bessel = (m == 0 ? 1.0 : std::numbers::sqrt2) * std::cyl_bessel_j(m, c);
        const double left = std::exp(-c / 4.0);  // at k sin(theta) = 4 sigma_t
        EXPECT_NEAR(sum * left, bessel * left, (m == 0 ? 1.0 : 3.0) * tolerance)
            << "modes " << modes << ", m " << m << ", c " << c;
      }
    for (const auto& rate : waves.rate) EXPECT_LT(rate.real(), 0.0);
  }
}

// What is taken out at each frequency is what is put in over radius.
TEST(SingleScatteringProfile, TransformsToItsResponse) {
  for (const char* name : {"skin, red", "glass slab", "Giovanelli half-space", "denser below"}) {
    const LayerStack& stack = reference::find_stack(name);
    const auto solver = detail::make_frequency_solver(stack, 40, 41);
    const auto once = detail::make_once_scattered(stack, solver.stack);
    for (const double k : {0.0, 5.0}) {
      const auto expected = detail::single_scattering_response(solver, k);
      const auto wave = [&](bool is_reflectance) {
        return over_plane([&](double r) {
          const auto at = detail::single_scattering_profile(once, r);
          return std::cyl_bessel_j(0.0, k * r) *
                 (is_reflectance ? at.reflectance : at.transmittance);
        });
      };
      EXPECT_NEAR(wave(true), expected.reflectance, 2e-5 * expected.reflectance)
          << name << ", k " << k;
      if (expected.transmittance > 0.0) {
        EXPECT_NEAR(wave(false), expected.transmittance, 2e-5 * expected.transmittance)
            << name << ", k " << k;
      }
    }
  }
}

// Within the grid the series is exact; beyond, the law of the tail goes on from what it has seen.
TEST(Spectrum, GoesThroughAndBeyondItsValues) {
  const auto solver =
      detail::make_frequency_solver(reference::find_stack("Giovanelli half-space"), 4, 1);
  const auto grid = detail::make_frequency_grid(solver.stack, 24);
  EXPECT_EQ(grid.highest, 40.0);
  const auto f = [](double k) { return 1.0 / (1.0 + k * k / 30.0); };
  std::vector<double> values;
  for (const double k : grid.k) values.push_back(f(k));
  const auto spectrum = detail::make_spectrum(grid, values);
  for (const double k : {0.0, 0.3, 4.0, 12.0})
    EXPECT_NEAR(detail::evaluate(spectrum, k) / f(k), 1.0, 1e-9) << "k " << k;
  for (const double k : {15.0, 25.0, 39.0, 60.0})
    EXPECT_NEAR(detail::evaluate(spectrum, k) / f(k), 1.0, 0.01) << "k " << k;
}

// The total of each way by depth first is that of its profile by distance first.
// All light that a dense layer under a clear one scatters once comes from its surface: the closed
// form of a point on it, seen through the layer above. It is within a narrow range of angles.
TEST(SingleScatteringProfile, OfADenseLayerBelowAnother) {
  constexpr double depth = 1.94, sigma_1 = 0.2, sigma_2 = 3000.0, albedo_2 = 0.4, ior = 1.42;
  const LayerStack stack(
      {{.medium = {.sigma_a = sigma_1, .sigma_s = 0.0, .ior = ior}, .thickness = depth},
       {.medium = {.sigma_a = (1.0 - albedo_2) * sigma_2,
                   .sigma_s = albedo_2 * sigma_2,
                   .ior = ior},
        .thickness = 0.04}});
  const std::vector<GridDirection> beams{direction_in(1.0, 0.0)};
  const auto light = detail::make_once_scattered(stack, detail::make_grid_stack(stack, 8, beams));
  for (const double r : {0.05, 0.3, 1.0, 1.6}) {
    const double mu = depth / std::hypot(depth, r);
    const auto entering = 1.0 - fresnel(1.0, ior), leaving = 1.0 - fresnel(mu, 1.0 / ior);
    const double expected = entering * std::exp(-sigma_1 * depth * (1.0 + 1.0 / mu)) * albedo_2 /
                            (4.0 * std::numbers::pi) * mu / (1.0 + mu) * leaving * mu * mu * mu /
                            (depth * depth);
    EXPECT_NEAR(detail::single_scattering_profile(light, r).reflectance / expected, 1.0, 2e-3) << r;
  }
}

TEST(SingleScatteringProfile, AddsUpToItsTotal) {
  for (const char* name : {"skin, red", "glass slab", "half-space, forward", "denser below"}) {
    const auto solver = detail::make_frequency_solver(reference::find_stack(name), 8, 1);
    const auto once = detail::make_once_scattered(reference::find_stack(name), solver.stack);
    const auto totals = detail::single_scattering_totals(once);
    const auto sum = [&](bool is_reflectance) {
      return over_plane([&](double r) {
        const auto at = detail::single_scattering_profile(once, r);
        return is_reflectance ? at.reflectance : at.transmittance;
      });
    };
    EXPECT_NEAR(sum(true), totals.reflectance, 2e-6 * totals.reflectance) << name;
    EXPECT_NEAR(sum(false), totals.transmittance, 2e-6 * totals.transmittance) << name;
  }
}

// All rings together hold as much light as adding-doubling finds to leave scattered.
TEST(TransferProfile, RingsAddUpToTheTotal) {
  const std::vector<LayerStack> bands = {reference::find_stack("skin, red"),
                                         reference::find_stack("skin, blue"),
                                         reference::find_stack("glass slab")};
  const TransferProfile exact =
      transfer_profile(bands, {.first = 3e-6, .last = 200.0, .size = 540});
  EXPECT_TRUE(exact.is_accurate);
  for (std::size_t band = 0; band < bands.size(); ++band) {
    const auto solved = adding_doubling(bands[band], {}, {.accuracy = 1e-6});
    const double reflected = solved.totals.specular_reflectance +
                             solved.totals.diffuse_reflectance - solved.unscattered_reflectance;
    const FluxCurve up = reflected_flux(exact.profile, band);
    EXPECT_NEAR(up.within.back() + up.beyond, reflected, 1e-6) << band;
    const FluxCurve down = transmitted_flux(exact.profile, band);
    EXPECT_NEAR(down.within.back() + down.beyond,
                solved.totals.transmittance - solved.unscattered_transmittance, 1e-6)
        << band;
    EXPECT_GE(*std::ranges::min_element(exact.profile.reflectance_profile), 0.0);
    EXPECT_GE(*std::ranges::min_element(exact.profile.transmittance_profile), 0.0);
  }
}

// Photon Monte Carlo shares nothing with the solver but Fresnel's law and the phase function.
TEST(TransferProfile, AgreesWithMonteCarloRingByRing) {
  struct Case {
    LayerStack stack;
    double outermost;  // [mm]
    double
        estimate_of_error;  // of the error, at most: for some the tail of the spectrum adds to .005
  };
  const std::vector<Case> cases = {
      {reference::find_stack("Giovanelli half-space"), 0.4, 0.006},
      {reference::find_stack("skin, green"), 0.6, 0.005},
      {reference::find_stack("van de Hulst slab"), 0.4, 0.03},
      {LayerStack({layer(0.5, 4.5, 0.0, 1.5, 0.04)}), 0.3, 0.005},     // optical thickness 0.2
      {LayerStack({layer(0.5, 4.5, 0.0, 1.5, 0.01)}), 0.2, 0.005},     // 0.05
      {LayerStack({layer(0.01, 100.0, 0.8, 1.5, 1.0)}), 1.0, 0.005}};  // white paint
  constexpr double ring = 0.02;
  for (const auto& [stack, outermost, estimate_of_error] : cases) {
    const auto rings = static_cast<std::size_t>(std::lround(outermost / ring));
    MonteCarloOptions options{.photons = 400'000, .seed = 3};
    options.tallies.r = {.count = static_cast<int>(rings), .width = ring};
    const MonteCarloResult photons = trace_photons(stack, options);
    const TransferProfile exact = transfer_profile(
        std::vector{stack}, {.first = 1e-4, .last = 20.0, .size = 160}, {.r_highest = outermost});
    EXPECT_LT(exact.estimated_error[0], estimate_of_error);
    const Quadrature rule = gauss_legendre(8, 0.0, 1.0);
    for (const bool is_reflectance : {true, false}) {
      if (!is_reflectance && is_semi_infinite(stack)) continue;
      double chi2 = 0.0;
      // The first ring holds light that never scattered, the last one all light beyond.
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
            is_reflectance ? photons.radial.reflection[i] : photons.radial.transmission[i];
        const double sigma = std::hypot(estimate.standard_error, 0.005 * mean);
        chi2 += std::pow((estimate.value - mean) / sigma, 2);
        EXPECT_NEAR(estimate.value, mean, 4.5 * sigma) << "ring " << i;
      }
      EXPECT_LT(chi2 / static_cast<double>(rings - 2), 1.6);
    }
  }
}

// Near the beam nearly all light is scattered once, in the top layer, however thin: photons of
// rings of a thousandth of a millimetre, and the law that no profile lies below light scattered
// once.
TEST(TransferProfile, SeesThinLayersNearTheBeam) {
  const LayerStack thin_over_dense(
      {layer(0.0155, 0.2936, 0.0, 1.148, 0.0349), layer(0.2517, 7.5855, 0.0, 1.074, infinite)}, 1.0,
      1.074);
  const LayerStack dense_over_thin(
      {layer(0.05, 9.0, 0.3, 1.4, 0.3), layer(0.01, 0.4, 0.0, 1.33, 0.02),
       layer(0.2, 12.0, 0.5, 1.4, infinite)},
      1.0, 1.4);
  for (const LayerStack& stack : {thin_over_dense, dense_over_thin}) {
    const TransferProfile exact =
        transfer_profile(std::array{stack}, {.first = 5e-4, .last = 20.0, .size = 160});
    const auto once = detail::make_once_scattered(
        stack, detail::make_grid_stack(stack, 8, std::vector{direction_in(1.0, 0.0)}));
    for (const double r : exact.profile.r) {
      if (r > 0.1) break;
      EXPECT_GT(reflectance_profile(exact.profile, r, 0),
                0.99 * detail::single_scattering_profile(once, r).reflectance)
          << r;
    }
  }
  // Waves that end before the top layer shows are 9 to 20 % low in these rings.
  const TransferProfile exact =
      transfer_profile(std::array{thin_over_dense}, {.first = 1e-3, .last = 100.0, .size = 256});
  MonteCarloOptions options{.photons = 4'000'000, .seed = 5};
  options.tallies.r = {.count = 8, .width = 0.002};
  const MonteCarloResult photons = trace_photons(thin_over_dense, options);
  const Quadrature rule = gauss_legendre(8, 0.0, 1.0);
  for (std::size_t i = 1; i < 7; ++i) {
    const double inner = 0.002 * static_cast<double>(i);
    double mean = 0.0;
    for (std::size_t q = 0; q < 8; ++q) {
      const double r = inner + 0.002 * rule.nodes[q];
      mean += rule.weights[q] * 2.0 * r / (2.0 * inner + 0.002) *
              reflectance_profile(exact.profile, r, 0);
    }
    const Estimate& ring = photons.radial.reflection[i];
    EXPECT_NEAR(mean, ring.value, 3.5 * ring.standard_error + 0.01 * mean) << i;
    EXPECT_LT(ring.standard_error, 0.025 * mean);
  }
}

// Plates throw rings of light far out, which waves do not resolve.
TEST(TransferProfile, PhotonsSeeTheRingsOfClearPlates) {
  for (const char* name : {"cover glass", "air gap"}) {
    const LayerStack stack = reference::find_stack(name);
    const RadialGrid grid{.first = 1e-2, .last = 20.0, .size = 300};
    const TransferProfile exact = transfer_profile(std::vector{stack}, grid);
    EXPECT_GT(exact.photons[0], 0u) << name;
    MonteCarloOptions options{.photons = 1'000'000, .seed = 8};
    options.tallies.log_r = {.count = 24, .low = 0.1, .high = 10.0};
    options.tallies.known_above = {.unscattered = KnownLight::all};
    const MonteCarloResult photons = trace_photons(stack, options);
    double wrong = 0.0, noise = 0.0, all = 0.0;
    for (std::size_t i = 0; i < 24; ++i) {
      const double begin = 0.1 * std::pow(100.0, static_cast<double>(i) / 24.0);
      const double end = begin * std::pow(100.0, 1.0 / 24.0);
      double density = 0.0, weight = 0.0;
      for (int q = 0; q < 20; ++q) {
        const double r = begin * std::pow(end / begin, (q + 0.5) / 20.0);
        density += r * r * reflectance_profile(exact.profile, r, 0);
        weight += r * r;
      }
      const Estimate& seen = photons.log_radial.reflection[i];
      const double area = std::numbers::pi * (end * end - begin * begin);
      wrong += area * std::abs(density / weight - seen.value);
      noise += area * seen.standard_error;
      all += area * seen.value;
    }
    EXPECT_LT(wrong, 0.01 * all + noise) << name;
  }
}

TEST(TransferProfile, RefusesWhatItCannotDo) {
  const std::vector<LayerStack> clear = {LayerStack({layer(1.0, 0.0, 0.0, 1.4, 1.0)})};
  EXPECT_THROW((void)transfer_profile(clear), InvalidInput);
  const LayerStack glass = reference::find_stack("cover glass");
  std::vector<Layer> layers(glass.layers().begin(), glass.layers().end());
  layers[0].top.roughness = 0.3;
  try {
    (void)transfer_profile(std::vector{LayerStack(layers, glass.ior_above(), glass.ior_below())});
    ADD_FAILURE() << "not refused";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("does not scatter"), std::string::npos);
  }
  const std::vector<LayerStack> slab = {LayerStack({layer(1.0, 9.0, 0.0, 1.4, 1.0)})};
  EXPECT_THROW((void)transfer_profile(slab, {}, {.accuracy = 1.0}), InvalidInput);
  EXPECT_THROW((void)transfer_profile(slab, {.first = 0.0}), InvalidInput);
  EXPECT_THROW((void)spatial_frequency_response(slab, std::vector{-1.0}), InvalidInput);
}

// Every further index cuts the directions once more.
TEST(TransferProfile, RefusesStacksThatTakeTooLongWithTheEstimate) {
  std::vector<Layer> layers;
  for (int i = 0; i < 120; ++i) layers.push_back(layer(0.1, 9.0, 0.0, 1.2 + 0.005 * i, 0.1));
  try {
    (void)transfer_profile(std::vector{LayerStack(layers)});
    FAIL() << "not refused";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("GiB"), std::string::npos) << error.what();
  }
  const auto few = detail::solution_cost(std::vector{reference::find_stack("skin, red")}, 5, 5, 24);
  EXPECT_GT(few.seconds, 0.02);  // 0.12 s measured
  EXPECT_LT(few.seconds, 0.5);
  EXPECT_LT(few.mebibytes, 20.0);
}

}  // namespace
}  // namespace lamina
