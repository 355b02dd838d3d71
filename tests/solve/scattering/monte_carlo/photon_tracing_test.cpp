// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/core/quadrature.h"
#include "literal/stack_table.h"

namespace lamina {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

LayerStack one_layer(const Medium& medium, double thickness, double above = 1.0,
                     double below = 1.0) {
  return LayerStack({{.medium = medium, .thickness = thickness}}, above, below);
}

/// A deviation in standard errors is below 4; the floor is the rounding of single precision.
void expect_agrees(const Estimate& estimate, double reference, double largest_error,
                   const char* what = "") {
  EXPECT_NEAR(estimate.value, reference, 4.0 * estimate.standard_error + 1e-6) << what;
  EXPECT_LE(estimate.standard_error, largest_error) << what;  // so that noise cannot hide a bias
}

// van de Hulst (1980), as quoted with more digits by Prahl's adding-doubling.
TEST(MonteCarlo, MatchedSlabAgreesWithVanDeHulst) {
  const LayerStack slab = one_layer({.sigma_a = 1.0, .sigma_s = 9.0, .g = 0.75}, 0.2);
  const MonteCarloResult result = trace_photons(slab, {.photons = 4'000'000, .seed = 1});
  expect_agrees(result.diffuse_reflectance, 0.0973946, 2e-4);
  expect_agrees(result.transmittance, 0.6609577, 3e-4);
  expect_agrees(result.unscattered_transmittance, std::exp(-2.0), 3e-4);
  EXPECT_EQ(result.specular_reflectance.value, 0.0);
}

// Giovanelli (1955), with the specular reflection of 0.04.
TEST(MonteCarlo, HalfSpaceOfGlassAgreesWithGiovanelli) {
  const LayerStack stack = one_layer({.sigma_a = 1.0, .sigma_s = 9.0, .ior = 1.5}, infinite);
  const MonteCarloResult result = trace_photons(stack, {.photons = 2'000'000, .seed = 2});
  EXPECT_NEAR(result.specular_reflectance.value, 0.04, 1e-12);
  expect_agrees(result.diffuse_reflectance, 0.2599186 - 0.04, 3e-4);
}

// [DonnerJensen2005] Table 3; the totals are those of adding-doubling.
TEST(MonteCarlo, SkinAgreesWithAddingDoubling) {
  const double expected[3] = {0.398083, 0.392509, 0.309059};
  const auto table = reference::stack_table();
  int channel = 0;
  for (const auto& [name, stack] : table) {
    if (!name.starts_with("skin")) continue;
    const MonteCarloResult result = trace_photons(stack, {.photons = 600'000, .seed = 3});
    EXPECT_NEAR(result.specular_reflectance.value, 0.0277778, 1e-6);
    expect_agrees(result.diffuse_reflectance, expected[channel++], 6e-4, name.c_str());
  }
  EXPECT_EQ(channel, 3);
}

/// Chandrasekhar's H-function of isotropic scattering, by the integral equation in the form of
/// [Chandrasekhar1960] §39: 1/H = sqrt(1 - W) + W/2 * integral of t H(t) / (mu + t).
double h_function(double albedo, double mu) {
  const Quadrature q = gauss_legendre(64, 0.0, 1.0);
  std::vector<double> h(q.nodes.size(), 1.0);
  const auto evaluate = [&](double at) {
    double sum = 0.0;
    for (std::size_t j = 0; j < h.size(); ++j)
      sum += q.weights[j] * q.nodes[j] * h[j] / (at + q.nodes[j]);
    return 1.0 / (std::sqrt(1.0 - albedo) + 0.5 * albedo * sum);
  };
  for (int i = 0; i < 400; ++i) {
    std::vector<double> next;
    for (const double node : q.nodes) next.push_back(evaluate(node));
    h = next;
  }
  return evaluate(mu);
}

TEST(MonteCarlo, IsotropicHalfSpaceAgreesWithChandrasekhar) {
  for (const double albedo : {0.3, 0.9})
    for (const double mu : {1.0, 0.3}) {
      const LayerStack stack = one_layer({.sigma_a = 1.0 - albedo, .sigma_s = albedo}, infinite);
      const MonteCarloResult result = trace_photons(stack, {.photons = 400'000,
                                                            .seed = 4,
                                                            .incidence = {.theta = std::acos(mu)},
                                                            .tallies = {.orders = true}});
      expect_agrees(result.diffuse_reflectance,
                    1.0 - std::sqrt(1.0 - albedo) * h_function(albedo, mu), 1e-3);
      // The part that is scattered once, in closed form.
      expect_agrees(result.by_order.reflection[1],
                    0.5 * albedo * (1.0 - mu * std::log(1.0 + 1.0 / mu)), 1e-3);
    }
}

TEST(MonteCarlo, EnergyIsConservedOnEveryStack) {
  for (const auto& [name, stack] : reference::stack_table()) {
    const MonteCarloResult result = trace_photons(stack, {.photons = 4000, .seed = 5});
    double sum = result.specular_reflectance.value + result.diffuse_reflectance.value +
                 result.transmittance.value + result.unfinished.value;
    double variance = 0.0;
    for (const Estimate& a : result.absorptance) {
      sum += a.value;
      variance += a.standard_error * a.standard_error;
    }
    // Photon by photon, whatever roulette does: what it gives to one it takes from absorption.
    EXPECT_NEAR(sum, 1.0, 2e-6) << name;
    EXPECT_GE(variance, 0.0);
  }
}

TEST(MonteCarlo, ResultDoesNotDependOnThreads) {
  const LayerStack stack = reference::stack_table()[27].stack;
  const MonteCarloOptions options = {
      .photons = 30'000,
      .seed = 6,
      .tallies = {.r = {20, 0.05}, .angles = 9, .depth = {20, 0.05}, .fluence = true}};
  set_thread_count(1);
  const PhotonCounts one = count_photons(stack, options);
  set_thread_count(0);
  const PhotonCounts all = count_photons(stack, options);
  EXPECT_EQ(one.first, all.first);
  EXPECT_EQ(one.second, all.second);
  EXPECT_EQ(one.volume_first, all.volume_first);
  EXPECT_EQ(one.volume_second, all.volume_second);
  EXPECT_EQ(one.photons, 30'000u);
}

/// The sums of two runs are the same, bit for bit.
void expect_equal(const PhotonCounts& a, const PhotonCounts& b) {
  EXPECT_EQ(a.first, b.first);
  EXPECT_EQ(a.second, b.second);
  EXPECT_EQ(a.volume_first, b.volume_first);
  EXPECT_EQ(a.volume_second, b.volume_second);
  EXPECT_EQ(a.photons, b.photons);
  EXPECT_EQ(a.batches, b.batches);
  EXPECT_EQ(a.events, b.events);
  EXPECT_EQ(a.was_stopped, b.was_stopped);
}

// Stopped after each report of progress, from any thread, and gone on with.
TEST(MonteCarlo, StoppedRunGoesOnToTheSameEnd) {
  const LayerStack stack = reference::stack_table()[25].stack;
  for (const double relative_error : {0.0, 0.05}) {
    MonteCarloOptions options = {.photons = 40'000,
                                 .seed = 7,
                                 .tallies = {.r = {20, 0.05}, .depth = {10, 0.1}},
                                 .relative_error = relative_error,
                                 .shard = {.index = 1, .count = 2}};
    const PhotonCounts whole = count_photons(stack, options);
    EXPECT_FALSE(whole.was_stopped);
    int kept = 0;
    PhotonCounts last;
    options.keep = [&](const PhotonCounts& counts) {
      last = counts;
      ++kept;
    };
    std::atomic<int> reports = 0;
    options.progress = [&](double) { return ++reports % 3 != 0; };
    PhotonCounts counts = count_photons(stack, options);
    while (counts.was_stopped) {
      expect_equal(last, counts);
      const std::uint64_t before = counts.batches;
      counts = continue_photons(stack, options, counts);
      ASSERT_GT(counts.batches, before);
    }
    EXPECT_GT(kept, 1);
    expect_equal(counts, whole);
    expect_equal(continue_photons(stack, options, whole), whole);
    MonteCarloOptions other = options;
    other.seed = 8;
    EXPECT_THROW((void)continue_photons(stack, other, whole), InvalidInput);
    other = options;
    other.tallies.r.count = 21;
    EXPECT_THROW((void)continue_photons(stack, other, whole), InvalidInput);
  }
}

TEST(MonteCarlo, ShardsAddUpToTheRunBitForBit) {
  const LayerStack stack = reference::stack_table()[25].stack;
  MonteCarloOptions options = {
      .photons = 40'000, .seed = 7, .tallies = {.r = {20, 0.05}, .angles = 9, .depth = {10, 0.1}}};
  options.shard.count = 1;
  const PhotonCounts whole = count_photons(stack, options);
  PhotonCounts sum;
  for (int i = 0; i < 3; ++i) {
    options.shard = {.index = i, .count = 3};
    const PhotonCounts part = count_photons(stack, options);
    sum = i == 0 ? part : merge_counts(sum, part);
  }
  EXPECT_EQ(whole.first, sum.first);
  EXPECT_EQ(whole.second, sum.second);
  EXPECT_EQ(whole.volume_first, sum.volume_first);
  EXPECT_EQ(whole.volume_second, sum.volume_second);
  EXPECT_EQ(whole.photons, sum.photons);
  options.seed = 8;
  EXPECT_THROW(merge_counts(sum, count_photons(stack, options)), InvalidInput);
}

}  // namespace
}  // namespace lamina
