// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/photon_tallies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "literal/stack_table.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();

LayerStack one_layer(const Medium& medium, double thickness) {
  return LayerStack({{.medium = medium, .thickness = thickness}});
}

TEST(WideSum, AddsWithCarryAndSign) {
  WideSum a = {.low = ~std::uint64_t{0}, .high = 0};
  add(a, {.low = 1, .high = 0});
  EXPECT_EQ(a, (WideSum{.low = 0, .high = 1}));
  EXPECT_DOUBLE_EQ(to_double(a, 64), 1.0);
  const WideSum minus_three = {.low = ~std::uint64_t{2}, .high = ~std::uint64_t{0}};
  EXPECT_DOUBLE_EQ(to_double(minus_three, 0), -3.0);
  add(a, minus_three);
  EXPECT_DOUBLE_EQ(to_double(a, 0), 0x1p64 - 3.0);
}

// The error of a count of few photons, or of none, over many runs: what was measured is that far
// from the truth on average, and a run that saw nothing does not exclude it.
TEST(Estimate, ErrorOfFewSamplesCoversTheTruth) {
  Random random(41);
  for (const double chance : {1e-4, 1e-3, 3e-3, 0.01, 0.5, 0.997}) {
    constexpr int runs = 400, samples = 1000;
    int within_two = 0;
    double squares = 0.0, expected = 0.0;
    for (int run = 0; run < runs; ++run) {
      int count = 0;
      for (int i = 0; i < samples; ++i) count += random.uniform() < chance ? 1 : 0;
      const Estimate e = sample_mean(samples, count, count);
      EXPECT_GT(e.standard_error, 0.0);
      within_two += std::abs(e.value - chance) <= 2.0 * e.standard_error ? 1 : 0;
      squares += std::pow(e.value - chance, 2);
      expected += e.standard_error * e.standard_error;
    }
    EXPECT_GT(within_two, 0.9 * runs) << chance;  // the common formula: 10, 63, 91 ... %
    EXPECT_LT(squares, 1.25 * expected) << chance;
    if (chance * samples > 5.0 && chance < 0.6) {
      EXPECT_GT(squares, 0.6 * expected) << chance;
    }
  }
  EXPECT_NEAR(sample_mean(1.0, 1.0, 1.0).standard_error, 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(sample_mean(1e6, 0.0, 0.0).standard_error, 1e-6, 1e-11);
  EXPECT_NEAR(sample_mean(1e6, 25e4, 25e4).standard_error, std::sqrt(0.25 * 0.75 / 1e6), 1e-9);
}

// Each grid is the same light cut another way.
TEST(PhotonTallies, EveryGridSumsToTheTotal) {
  const auto table = reference::stack_table();
  const LayerStack& stack = table[26].stack;
  const PhotonTallies t = {.r = {15, 0.03},
                           .angles = 12,
                           .log_r = {20, 1e-3, 10.0},
                           .depth = {12, 0.05},
                           .bsdf_cosines = 6,
                           .bsdf_azimuths = 8,
                           .orders = true,
                           .path_length = {30, 0.1}};
  const MonteCarloResult result =
      trace_photons(stack, {.photons = 30'000, .seed = 9, .tallies = t});
  for (const bool below : {false, true}) {
    const auto pick = [&](const TwoSided& both) {
      return below ? both.transmission : both.reflection;
    };
    const double total = below ? result.transmittance.value : result.diffuse_reflectance.value;
    const double unscattered =
        below ? result.unscattered_transmittance.value : result.unscattered_reflectance.value;
    double radial = 0.0, angular = 0.0, log_radial = 0.0, bsdf = 0.0, order = 0.0, path = 0.0,
           by_order = 0.0;
    for (int i = 0; i < 15; ++i)
      radial +=
          pi * 0.03 * 0.03 * (2 * i + 1) * pick(result.radial)[static_cast<std::size_t>(i)].value;
    const double a = 0.5 * pi / 12;
    for (int i = 0; i < 12; ++i)
      angular += 2.0 * pi * (std::cos(i * a) - std::cos((i + 1) * a)) *
                 pick(result.angular)[static_cast<std::size_t>(i)].value;
    for (int i = 0; i < 20; ++i) {
      const double low = 1e-3 * std::pow(1e4, i / 20.0),
                   high = 1e-3 * std::pow(1e4, (i + 1) / 20.0);
      log_radial += pi * (high * high - low * low) *
                    pick(result.log_radial)[static_cast<std::size_t>(i)].value;
    }
    for (const Estimate& e : pick(result.log_radial_outside)) log_radial += e.value;
    for (int i = 0; i < 48; ++i)
      bsdf += 2.0 * pi / 48 * ((i / 8) + 0.5) / 6.0 *
              pick(result.bsdf)[static_cast<std::size_t>(i)].value;
    for (const Estimate& e : pick(result.bsdf_by_order)) by_order += e.value;
    double sum_bsdf = 0.0;
    for (const Estimate& e : pick(result.bsdf)) sum_bsdf += e.value;
    for (const Estimate& e : pick(result.by_order)) order += e.value;
    for (const Estimate& e : pick(result.path_length)) path += 0.1 * e.value;
    EXPECT_NEAR(radial, total, 1e-9);
    EXPECT_NEAR(angular, total, 1e-9);
    EXPECT_NEAR(log_radial, total, 1e-9);
    EXPECT_NEAR(bsdf, total - unscattered, 1e-9);
    EXPECT_NEAR(by_order, sum_bsdf, 1e-9 * sum_bsdf);
    EXPECT_NEAR(order, total, 1e-9);
    EXPECT_NEAR(path, total, 1e-9);
  }
  double absorbed = 0.0, error = 0.0;
  for (std::size_t i = 0; i < result.absorption.size(); ++i) {
    const double volume = pi * 0.03 * 0.03 * (2.0 * static_cast<double>(i / 12) + 1.0) * 0.05;
    absorbed += volume * result.absorption[i].value;
    error += volume * result.absorption[i].standard_error;  // at most
  }
  EXPECT_NEAR(absorbed, result.absorptance[0].value + result.absorptance[1].value, 4.0 * error);
}

// [HanrahanKrueger1993] first order on a matched half-space, as in [Chandrasekhar1960]: the BRDF of
// light scattered once is W p / (mu_i + mu_r).
TEST(PhotonTallies, FirstOrderHasItsClosedForm) {
  const double albedo = 0.6, g = 0.5, theta = 0.8;
  const MonteCarloResult result =
      trace_photons(one_layer({.sigma_a = 1.0 - albedo, .sigma_s = albedo, .g = g}, infinite),
                    {.photons = 1'500'000,
                     .seed = 10,
                     .incidence = {.theta = theta},
                     .tallies = {.bsdf_cosines = 5, .bsdf_azimuths = 8, .orders = true}});
  double chi = 0.0;
  for (std::size_t row = 0; row < 5; ++row)
    for (std::size_t column = 0; column < 8; ++column) {
      // Mean of flux over the cell by a midpoint rule of 20 x 20, then over its middle cosine.
      double sum = 0.0;
      for (int i = 0; i < 20; ++i)
        for (int j = 0; j < 20; ++j) {
          const double mu = (static_cast<double>(row) + (i + 0.5) / 20) / 5.0;
          const double phi = 2.0 * pi * (static_cast<double>(column) + (j + 0.5) / 20) / 8.0;
          const double cos_scatter =
              -mu * std::cos(theta) + std::sqrt(1.0 - mu * mu) * std::sin(theta) * std::cos(phi);
          const double brdf =
              albedo * evaluate(HenyeyGreenstein{g}, cos_scatter) / (mu + std::cos(theta));
          sum += brdf * mu / 400.0;
        }
      const double expected = sum / ((static_cast<double>(row) + 0.5) / 5.0);
      const Estimate& e = result.bsdf_by_order.reflection[40 + row * 8 + column];
      EXPECT_NEAR(e.value, expected, 4.5 * e.standard_error) << row << ' ' << column;
      EXPECT_LT(e.standard_error, 0.05 * expected + 1e-3);
      chi += std::pow((e.value - expected) / e.standard_error, 2);
    }
  EXPECT_LT(chi, 40.0 + 4.0 * std::sqrt(80.0));
}

// A sharp forward peak, looked at straight into it: light scattered once by a thin slab has the
// phase function itself, (1 + g) / (4 pi (1 - g)^2); twice, that of g^2.
TEST(PhotonTallies, NextEventsKeepTheForwardPeak) {
  const double tau = 0.01;
  for (const double g : {0.995, 0.999})
    for (const double theta : {0.0, 0.5}) {
      const auto peak = [](double G) { return (1.0 + G) / (4.0 * pi * (1.0 - G) * (1.0 - G)); };
      const double path = tau / std::cos(theta);
      const double expected =
          std::exp(-path) / std::cos(theta) * (path * peak(g) + 0.5 * path * path * peak(g * g));
      const MonteCarloResult result =
          trace_photons(one_layer({.sigma_s = 1.0, .g = g}, tau),
                        {.photons = 2'000'000,
                         .seed = 23,
                         .incidence = {.theta = theta},
                         .tallies = {.directions = {{.theta = theta, .is_below = true}}}});
      EXPECT_NEAR(result.directions[0].value, expected, 0.02 * expected) << g << ' ' << theta;
      EXPECT_LT(result.directions[0].standard_error, 0.008 * expected);
    }
}

// Light in a pure absorber decays exponentially, and absorbs sigma_a times its fluence.
TEST(PhotonTallies, FluenceAndAbsorptionFollowBeersLaw) {
  const double sigma_a = 2.0;
  const MonteCarloResult result =
      trace_photons(one_layer({.sigma_a = sigma_a}, 1.0),
                    {.photons = 200'000,
                     .seed = 11,
                     .tallies = {.r = {1, 1.0}, .depth = {10, 0.1}, .fluence = true}});
  for (std::size_t i = 0; i < 10; ++i) {
    const double low = 0.1 * static_cast<double>(i);
    const double expected =  // mean fluence over the bin, per area of the ring
        (std::exp(-sigma_a * low) - std::exp(-sigma_a * (low + 0.1))) / (sigma_a * 0.1 * pi);
    EXPECT_NEAR(result.fluence[i].value, expected, 5.0 * result.fluence[i].standard_error);
    EXPECT_NEAR(result.absorption[i].value, sigma_a * result.fluence[i].value, 1e-5);
    EXPECT_GT(result.fluence[i].standard_error, 0.0);
    EXPECT_LT(result.fluence[i].standard_error, 0.03 * expected);
  }
}

// The mean path of reflected light does not depend on absorption's place: -d ln R / d sigma_a is
// the mean path length, for any medium (the modified law of Beer and Lambert).
TEST(PhotonTallies, MeanPathIsTheLogarithmicDerivativeByAbsorption) {
  const auto reflectance = [](double sigma_a) {
    return trace_photons(
        one_layer({.sigma_a = sigma_a, .sigma_s = 10.0, .g = 0.5, .ior = 1.4}, 1.0),
        {.photons = 2'000'000, .seed = 12, .tallies = {.mean_path_length = true}});
  };
  const MonteCarloResult low = reflectance(0.19), middle = reflectance(0.2),
                         high = reflectance(0.21);
  const auto slope = [](const Estimate& a, const Estimate& b) {
    return std::log(a.value / b.value) / 0.02;
  };
  const auto error = [](const Estimate& a) { return 1.5 * a.standard_error / (0.02 * a.value); };
  EXPECT_NEAR(slope(low.diffuse_reflectance, high.diffuse_reflectance),
              middle.mean_path_reflected.value, 4.0 * error(middle.diffuse_reflectance));
  EXPECT_NEAR(slope(low.transmittance, high.transmittance), middle.mean_path_transmitted.value,
              4.0 * error(middle.transmittance));
  EXPECT_LT(error(middle.diffuse_reflectance), 0.15 * middle.mean_path_reflected.value);
}

// Mean paths of many runs scatter as each of them says.
TEST(PhotonTallies, ErrorOfTheMeanPathIsItsScatter) {
  const LayerStack slab = one_layer({.sigma_a = 0.2, .sigma_s = 10.0, .g = 0.5, .ior = 1.4}, 1.0);
  constexpr int runs = 300;
  for (const bool transmitted : {false, true}) {
    double sum = 0.0, squares = 0.0, expected = 0.0;
    for (int run = 0; run < runs; ++run) {
      const MonteCarloResult result =
          trace_photons(slab, {.photons = 1500,
                               .seed = 100 + static_cast<std::uint64_t>(run),
                               .tallies = {.mean_path_length = true}});
      const Estimate& e = transmitted ? result.mean_path_transmitted : result.mean_path_reflected;
      sum += e.value;
      squares += e.value * e.value;
      expected += e.standard_error * e.standard_error / runs;
    }
    const double variance = (squares - sum * sum / runs) / (runs - 1);
    // 300 runs know a standard deviation to 4 %.
    EXPECT_NEAR(std::sqrt(variance / expected), 1.0, 0.15) << transmitted;
  }
}

// Thin or thick, the paths of straight light are the thickness, to the digits of their sums.
TEST(PhotonTallies, MeanPathOfStraightLightIsTheThickness) {
  for (const double thickness : {1e-3, 1.0, 1e3}) {
    const MonteCarloResult result =
        trace_photons(one_layer({.sigma_a = 1e-4 / thickness}, thickness),
                      {.photons = 2000, .seed = 5, .tallies = {.mean_path_length = true}});
    const Estimate& e = result.mean_path_transmitted;
    EXPECT_NEAR(e.value, thickness, 1e-5 * thickness);
    EXPECT_LT(e.standard_error, 2e-3 * thickness);
  }
}

// What never scattered, or once, by the orders that are counted beside it. A ground's light is all
// kept, and reflections inside set light apart.
TEST(PhotonTallies, KnownLightIsLeftOutOfLogR) {
  const LayerStack slab(
      {{.medium = {.sigma_a = 0.2, .sigma_s = 2.0, .g = 0.6, .ior = 1.4}, .thickness = 0.5}});
  const auto light = [](const LayerStack& stack, KnownLight known) {
    MonteCarloOptions options{.photons = 100'000, .seed = 3};
    options.tallies = {.log_r = {20, 1e-3, 10.0}, .orders = true};
    options.tallies.known_above = options.tallies.known_below = known;
    return trace_photons(stack, options);
  };
  const auto all_rings = [](const MonteCarloResult& result, bool is_above) {
    const auto& outside =
        is_above ? result.log_radial_outside.reflection : result.log_radial_outside.transmission;
    double sum = outside[0].value + outside[1].value;
    for (int i = 0; i < 20; ++i) {
      const double low = 1e-3 * std::pow(10.0, 0.2 * i), high = low * std::pow(10.0, 0.2);
      sum += pi * (high * high - low * low) *
             (is_above ? result.log_radial.reflection
                       : result.log_radial.transmission)[static_cast<std::size_t>(i)]
                 .value;
    }
    return sum;
  };
  const auto orders_from = [](const MonteCarloResult& result, bool is_above, std::size_t first) {
    const auto& orders = is_above ? result.by_order.reflection : result.by_order.transmission;
    double sum = 0.0;
    for (std::size_t k = first; k < orders.size(); ++k) sum += orders[k].value;
    return sum;
  };
  constexpr int all = KnownLight::all;
  for (const bool is_above : {true, false}) {
    const auto none = light(slab, {}), zero = light(slab, {.unscattered = all}),
               one = light(slab, {.unscattered = all, .once = all}),
               straight = light(slab, {.unscattered = all, .once = 0});
    EXPECT_NEAR(all_rings(none, is_above), orders_from(none, is_above, 0), 1e-9);
    EXPECT_NEAR(all_rings(zero, is_above), orders_from(none, is_above, 1), 1e-9);
    EXPECT_NEAR(all_rings(one, is_above), orders_from(none, is_above, 2), 1e-9);
    EXPECT_GT(all_rings(straight, is_above), 1.001 * all_rings(one, is_above));
    EXPECT_LT(all_rings(straight, is_above), 0.99 * all_rings(zero, is_above));
  }
  const LayerStack clear({{.medium = {.ior = 1.0}, .thickness = 0.5}}, 1.0, 1.0,
                         {.reflectance = 1.0});
  EXPECT_NEAR(all_rings(light(clear, {.unscattered = all, .once = all}), true), 1.0, 1e-9);
}

// Light nearer than the first bin of log_r, or farther than the last, is beside the bins, and not a
// density in them.
TEST(PhotonTallies, LogarithmicBinsHoldOnlyTheirOwnLight) {
  const LayerStack half_space =
      one_layer({.sigma_a = 0.1, .sigma_s = 10.0, .g = 0.8, .ior = 1.4}, infinite);
  const auto traced = [&](const LogBins& bins) {
    return trace_photons(half_space, {.photons = 50'000, .seed = 14, .tallies = {.log_r = bins}});
  };
  const MonteCarloResult wide = traced({12, 1e-3, 1e3}), narrow = traced({4, 0.1, 10.0});
  double nearer = wide.log_radial_outside.reflection[0].value,
         farther = wide.log_radial_outside.reflection[1].value;
  for (std::size_t i = 0; i < 12; ++i) {
    const double low = 1e-3 * std::pow(10.0, 0.5 * static_cast<double>(i));
    const Estimate& e = wide.log_radial.reflection[i];
    if (i >= 4 && i < 8) {
      EXPECT_NEAR(narrow.log_radial.reflection[i - 4].value, e.value, 1e-3 * e.value) << i;
      continue;
    }
    (i < 4 ? nearer : farther) += pi * low * low * (10.0 - 1.0) * e.value;
  }
  EXPECT_NEAR(narrow.log_radial_outside.reflection[0].value, nearer, 1e-4);
  EXPECT_NEAR(narrow.log_radial_outside.reflection[1].value, farther, 1e-4);
  EXPECT_GT(nearer, 0.01);
}

// A count that no photon met has an upper bound, not an error of 0; what is known without chance is
// known.
TEST(PhotonTallies, NothingSeenIsNotCertain) {
  // A thick diffuser lets some 1e-4 through, which 200 photons do not see.
  const LayerStack paint = one_layer({.sigma_a = 0.05, .sigma_s = 100.0, .ior = 1.5}, 1.0);
  const MonteCarloResult few = trace_photons(
      paint, {.photons = 200, .seed = 3, .tallies = {.r = {10, 1.0}, .depth = {4, 0.5}}});
  const double truth = trace_photons(paint, {.photons = 200'000, .seed = 4}).transmittance.value;
  EXPECT_GT(truth, 0.0);
  EXPECT_NEAR(few.transmittance.value, truth, 3.0 * few.transmittance.standard_error);
  EXPECT_GT(few.transmittance.standard_error, 1e-3);
  for (const auto* cells : {&few.radial.reflection, &few.radial.transmission, &few.absorption})
    for (const Estimate& e : *cells) EXPECT_GT(e.standard_error, 0.0);
  EXPECT_EQ(few.specular_reflectance.standard_error, 0.0);
  const MonteCarloResult one = trace_photons(one_layer({.sigma_a = 1e-9}, 1.0), {.photons = 1});
  EXPECT_EQ(one.transmittance.value, 1.0);
  EXPECT_NEAR(one.transmittance.standard_error, 1.0 / 3.0, 1e-6);
}

// A run does not stop at a transmittance of 0 ± 0 that it has not seen yet: after 4096 photons,
// that of an optical thickness of 9 may be 5e-4 just as well. Where none of so many photons came
// that it is below 1e-4, the run does not wait for one.
TEST(PhotonTallies, RelativeErrorWaitsForWhatWasNotSeenYet) {
  const MonteCarloResult filter = trace_photons(
      one_layer({.sigma_a = 9.0}, 1.0), {.photons = 6000, .seed = 7, .relative_error = 0.5});
  EXPECT_EQ(filter.photons, 6000u);
  const MonteCarloResult half_space =
      trace_photons(one_layer({.sigma_a = 1.0, .sigma_s = 10.0}, infinite),
                    {.photons = 1'000'000, .seed = 7, .relative_error = 0.05});
  EXPECT_EQ(half_space.transmittance.value, 0.0);
  EXPECT_LT(half_space.photons, 300'000u);
}

// A product of counts beyond 2^64 must not come to a small one.
TEST(PhotonLayout, RefusesCellsThatCannotBeCounted) {
  const auto complaint = [](const PhotonTallies& t, std::size_t layers) -> std::string {
    try {
      static_cast<void>(make_photon_layout(t, layers));
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  // 12 * 900000013 * 854015917 cells and those of path lengths wrap to 4 GiB and less.
  const PhotonTallies wraps = {.bsdf_cosines = 900000013,
                               .bsdf_azimuths = 854015917,
                               .orders = true,
                               .path_length = {28292772, 1.0},
                               .mean_path_length = true};
  EXPECT_EQ(complaint(wraps, 1).find("tallies: "), 0u) << complaint(wraps, 1);
  EXPECT_NE(complaint({.r = {1'000'000'000, 1.0}, .angles = 1'000'000'000}, 1), "");
  EXPECT_NE(complaint({.r = {1'000'000'000, 1.0}, .depth = {1'000'000'000, 1.0}}, 1), "");
  EXPECT_NE(complaint({}, ~std::size_t{0}), "");
  EXPECT_EQ(complaint({.r = {1000, 1.0}, .angles = 100}, 3), "");
}

TEST(PhotonTallies, DetectorsReadTheRadialProfile) {
  const MonteCarloResult result =
      trace_photons(one_layer({.sigma_a = 0.1, .sigma_s = 10.0, .g = 0.8, .ior = 1.4}, infinite),
                    {.photons = 50'000,
                     .seed = 13,
                     .tallies = {.r = {20, 0.2}, .detectors = {0.5, 2.1}, .detector_width = 0.2}});
  EXPECT_NEAR(result.detectors[0].value, result.radial.reflection[2].value, 1e-12);
  EXPECT_NEAR(result.detectors[1].value, result.radial.reflection[10].value, 1e-12);
  EXPECT_NEAR(result.detectors[1].standard_error, result.radial.reflection[10].standard_error,
              1e-12);
}

TEST(PhotonTallies, RefusesWhatMakesNoSense) {
  const LayerStack stack = one_layer({.sigma_a = 1.0}, 1.0);
  const auto complaint = [&](const MonteCarloOptions& options) -> std::string {
    try {
      static_cast<void>(trace_photons(stack, options));
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint({.photons = 0}), "photons must lie in [1, 1e15], but is 0");
  EXPECT_NE(complaint({.photons = 1, .incidence = {.theta = 2.0}}), "");
  EXPECT_NE(complaint({.photons = 1, .beam = {.shape = Beam::Shape::flat}}), "");
  EXPECT_NE(complaint({.photons = 1, .relative_error = -1.0}), "");
  EXPECT_NE(complaint({.photons = 1, .seconds = std::nan("")}), "");
  EXPECT_NE(complaint({.photons = 1, .shard = {.index = 2, .count = 2}}), "");
  EXPECT_NE(complaint({.photons = 1, .max_events = 0}), "");
  EXPECT_NE(complaint({.photons = 1, .roulette_weight = 0.0}), "");
  EXPECT_NE(complaint({.photons = 1, .tallies = {.r = {-1, 1.0}}}), "");
  EXPECT_NE(complaint({.photons = 1, .tallies = {.r = {1, 0.0}}}), "");
  EXPECT_NE(complaint({.photons = 1, .tallies = {.depth = {1, 1.0}}}), "");
  EXPECT_NE(complaint({.photons = 1, .tallies = {.log_r = {10, 1.0, 0.5}}}), "");
  EXPECT_NE(complaint({.photons = 1, .tallies = {.detectors = {1.0}}}), "");
  // The size is said.
  const std::string large =
      complaint({.photons = 1, .tallies = {.r = {100'000, 0.1}, .depth = {100'000, 0.1}}});
  EXPECT_NE(large.find("must fit in 4 GiB, but need"), large.npos) << large;
}

}  // namespace
}  // namespace lamina
