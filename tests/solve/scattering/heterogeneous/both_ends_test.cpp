// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/internal/both_ends.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "lamina/solve/scattering/heterogeneous/heterogeneous_transport.h"
#include "lamina/solve/scattering/monte_carlo/patch_photons.h"

namespace lamina {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Two operators whose weights fall fourfold and thirtyfold over the range.
std::array<std::vector<double>, 4> weights_at(double x) {
  return {std::vector{std::exp(-0.7 * x), 0.3 * std::exp(-1.7 * x)}, {}, {}, {0.2 + 0.1 * x}};
}

double mean_of_both(const detail::BothEnds& ends, std::size_t which, std::size_t gaussian, double x,
                    double y) {
  double sum = 0.0;
  for (std::size_t t = 0; t < ends.terms(); ++t)
    sum += ends.exit(t, which, x)[gaussian] * ends.entry(t, y);
  return sum;
}

TEST(BothEnds, AreTheProfileOfTheMeanOfTheirCoordinates) {
  const detail::BothEnds two(weights_at, 2), four(weights_at, 4);
  for (const double x : {-1.0, -0.3, 0.4, 1.0})
    for (const double y : {-0.9, 0.0, 0.55, 1.0})
      for (const std::size_t gaussian : {0u, 1u}) {
        const double wanted = weights_at(0.5 * (x + y))[0][gaussian];
        EXPECT_NEAR(mean_of_both(two, 0, gaussian, x, y), wanted, 0.04) << x << ' ' << y;
        EXPECT_NEAR(mean_of_both(four, 0, gaussian, x, y), wanted, 1e-4) << x << ' ' << y;
        EXPECT_NEAR(mean_of_both(two, 0, gaussian, x, x), weights_at(x)[0][gaussian], 1e-12);
      }
}

/// An epidermis of 1 mm² whose left half absorbs little, over a dermis.
struct Halves {
  static constexpr int size = 24;
  StackTables tables = make_stack_tables(
      {1.0, {{20.0, 0.75, 1.4, 0.25}, {20.0, 0.75, 1.38, 1e30}}, 1.38}, OperatorTotals::diffusion,
      {}, {.lowest = 0.1, .highest = 10.0, .rows = 32});
  std::vector<Plane> sigma_a = {make_plane(size, size, 0.8f), make_plane(size, size, 0.2f)};
  Halves() {
    for (int y = 0; y < size; ++y)
      for (int x = size / 2; x < size; ++x)
        sigma_a[0].values[static_cast<std::size_t>(y * size + x)] = 4.5f;
  }
  /// What leaves at one texel of the light that enters at another.
  [[nodiscard]] double exchanged(ProfileAt profile, std::size_t from, std::size_t to) const {
    const auto layers =
        make_heterogeneous_layers(tables, sigma_a, {make_plane(size, size)}, 1.0 / size, profile);
    Plane light = make_plane(size, size);
    light.values[from] = 1.0f;
    return static_cast<double>(transport(layers, light).reflected.values[to]);
  }
};

// The paper's profiles do not: where light comes out dark, less does than the other way.
TEST(BothEnds, ExchangeAlikeAcrossAnEdge) {
  const Halves halves;
  const std::size_t pale = 12 * 24 + 8, dark = 12 * 24 + 15;
  const double paper =
      halves.exchanged(ProfileAt::exit, pale, dark) / halves.exchanged(ProfileAt::exit, dark, pale);
  const double both =
      halves.exchanged(ProfileAt::both, pale, dark) / halves.exchanged(ProfileAt::both, dark, pale);
  EXPECT_LT(paper, 0.8);
  EXPECT_NEAR(both, 1.0, 0.05);
}

// Stripes of .6 mm, dark and pale, in even light, against photons; all stripes are alike, so their
// halves are averaged: six places.
TEST(BothEnds, AreBetterOnStripesThanTheExitAlone) {
  constexpr int columns = 96, rows = 16, places = 6;
  constexpr double texel = 0.1, pale = 0.82, dark = 4.5, dermis = 0.15;
  const Medium epidermis{.sigma_a = pale, .sigma_s = 19.4, .g = 0.756, .ior = 1.4};
  const LayerStack stack({{.medium = epidermis, .thickness = 0.25},
                          {.medium = {dermis, 19.4, 0.756, 1.38}, .thickness = infinite}},
                         1.0, 1.38);
  Patch scene{.stack = stack, .columns = columns, .rows = 1, .texel = texel};
  std::vector<double> row;
  std::vector<Plane> sigma_a = {make_plane(columns, rows), make_plane(columns, rows, 0.15f)};
  const auto place_of = [](int x) { return x % 12 < 6 ? (x % 12) : 11 - x % 12; };  // 3, 4, 5: dark
  for (int x = 0; x < columns; ++x) row.push_back(place_of(x) >= 3 ? dark : pale);
  for (std::size_t i = 0; i < sigma_a[0].values.size(); ++i)
    sigma_a[0].values[i] = static_cast<float>(row[i % columns]);
  scene.sigma_a = {row, {}};
  scene.irradiance.assign(columns, 1.0);
  const PatchPhotons photons = trace_patch_photons(scene, {.photons = 100'000, .seed = 3});
  const auto by_place = [&](const auto& value_at) {
    std::array<double, places> means{};
    for (int x = 0; x < columns; ++x)
      means[static_cast<std::size_t>(place_of(x))] +=
          value_at(static_cast<std::size_t>(x)) * places / columns;
    return means;
  };
  const auto truth = by_place([&](std::size_t x) { return photons.exitance[x].value; });
  const StackTables tables =
      make_stack_tables({1.0, {{19.4, 0.756, 1.4, 0.25}, {19.4, 0.756, 1.38, infinite}}, 1.38},
                        OperatorTotals::radiative_transfer, std::vector{2.0, dermis});
  const double entering = 1.0 - std::pow(0.4 / 2.4, 2);
  const auto error = [&](ProfileAt profile) {
    const auto layers =
        make_heterogeneous_layers(tables, sigma_a, {make_plane(columns, rows)}, texel, profile);
    const Plane seen =
        transport(layers, make_plane(columns, rows, static_cast<float>(entering))).reflected;
    const auto found = by_place([&](std::size_t x) { return static_cast<double>(seen.values[x]); });
    double square = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < places; ++i)
      square += std::pow(found[i] - truth[i], 2), sum += truth[i];
    return std::sqrt(square * places) / sum;
  };
  EXPECT_GT(error(ProfileAt::exit), 0.2);
  EXPECT_LT(error(ProfileAt::both), 0.07);
}

TEST(PathAbsorption, KnowsTheDecayLengthWhereItChanges) {
  LayerTexels texels = uniform_texels({.sigma_a = 1.0, .sigma_s = 20.0, .g = 0.75});
  texels.sigma_a = {0.82f, 0.82f, 4.5f, 4.5f};
  PathAbsorption<float> absorption(texels.sigma_a, reduced_scattering(texels));
  for (std::size_t i = 0; i < 3; ++i) absorption.add_neighbors(i, i + 1);
  const double decay = 0.5 * (std::sqrt(3.0 * 0.82 * 5.82) + std::sqrt(3.0 * 4.5 * 9.5));
  EXPECT_NEAR(absorption.decay_length(), 1.0 / decay, 1e-6);
  texels.sigma_a.assign(4, 0.82f);
  const PathAbsorption<float> uniform(texels.sigma_a, reduced_scattering(texels));
  EXPECT_EQ(uniform.decay_length(), 0.0);
}

// A wave that is much shorter than light goes keeps what scatters a few times only: without blurs
// waves of 5/mm would show 1.5 times as strong, and with those of diffuse light alone none of
// 20/mm would (docs/validation.md).
TEST(PathAbsorption, KeepsShortWavesByThreeTenths) {
  const std::array<double, 2> variances = path_variances(0.4);
  const auto left = [&](double k) {
    return sum_by_shares({std::vector{std::exp(-0.5 * variances[0] * k * k)},
                          std::vector{std::exp(-0.5 * variances[1] * k * k)}})[0];
  };
  EXPECT_NEAR(left(0.0), 1.0, 1e-12);
  EXPECT_NEAR(left(5.0), 0.72, 0.01);
  EXPECT_NEAR(left(20.0), 0.28, 0.01);
}

}  // namespace
}  // namespace lamina
