// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"
#include "lamina/solve/scattering/transport_profile/oblique_profile.h"
#include "lamina/solve/scattering/transport_profile/spatial_frequency_response.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

// Thin slabs of forward scattering, whose spectra no law continues: waves ring, photons know
// better, and estimates of their errors must hold.

namespace lamina {
namespace {

constexpr double ring = 0.01;
constexpr int rings = 40;

LayerStack slab(double thickness, double optical_thickness, double g, double ground = 0.0) {
  const double sigma_t = optical_thickness / thickness;
  const Layer layer{
      .medium = {.sigma_a = 0.01 * sigma_t, .sigma_s = 0.99 * sigma_t, .g = g, .ior = 1.4},
      .thickness = thickness};
  return LayerStack({layer}, 1.0, 1.0, {.reflectance = ground});
}

MonteCarloResult photons_of(const LayerStack& stack, const Incidence& incidence) {
  MonteCarloOptions options{.photons = 2'000'000, .seed = 5, .incidence = incidence};
  options.tallies.r = {.count = rings, .width = ring};
  return trace_photons(stack, options);
}

/// Share of the rings whose error, 2 standard errors of the photons taken off, is within what the
/// profile says of itself. The first rings hold light that never scattered.
struct Coverage {
  double share = 0.0, worst = 0.0;  ///< and the largest error
};

/// @param left_out  a distance whose ring is no matter: of a beam that went through, of an edge.
Coverage covered(const std::vector<double>& r, const std::vector<double>& value,
                 const std::vector<double>& error, const std::vector<Estimate>& photons,
                 double left_out = -1.0) {
  const auto at = [&](const std::vector<double>& table, double x) {
    const auto above = std::ranges::lower_bound(r, x);
    const auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - r.begin(), 1));
    const double share = (x - r[i - 1]) / (r[i] - r[i - 1]);
    return (1.0 - share) * table[i - 1] + share * table[i];
  };
  Coverage result;
  int within = 0, counted = 0;
  for (std::size_t k = 2; k + 1 < static_cast<std::size_t>(rings); ++k) {
    if (static_cast<double>(k) * ring <= left_out && left_out < static_cast<double>(k + 1) * ring)
      continue;
    constexpr int parts = 16;
    double mean = 0.0, stated = 0.0, weight = 0.0;
    for (int q = 0; q < parts; ++q) {
      const double x = (static_cast<double>(k) + (q + 0.5) / parts) * ring;
      mean += x * at(value, x);
      weight += x;
      stated = std::max(stated, at(error, x));
    }
    mean /= weight;
    const double noise = 2.0 * photons[k].standard_error / photons[k].value;
    const double wrong = std::max(std::abs(mean / photons[k].value - 1.0) - noise, 0.0);
    result.worst = std::max(result.worst, wrong);
    within += wrong <= stated ? 1 : 0;
    ++counted;
  }
  result.share = static_cast<double>(within) / counted;
  return result;
}

constexpr RadialGrid fine_radii{.first = 1e-3, .last = 20.0, .size = 300};

TEST(TransferProfileError, ThatOfTransmissionThroughAThinSlabIsSmall) {
  const LayerStack stack = slab(0.1, 2.0, 0.9);
  const auto exact = transfer_profile(std::vector{stack}, fine_radii);
  const auto photons = photons_of(stack, {});
  const Coverage t = covered(exact.profile.r, exact.profile.transmittance_profile,
                             exact.transmittance_error, photons.radial.transmission);
  EXPECT_LT(t.worst, 0.01);  // waves: 0.15
  EXPECT_GE(t.share, 0.95);
  const Coverage r = covered(exact.profile.r, exact.profile.reflectance_profile,
                             exact.relative_error, photons.radial.reflection);
  EXPECT_LT(r.worst, 0.02);
  EXPECT_GE(r.share, 0.95);
  EXPECT_GT(exact.photons[0], 1'000'000u);
  EXPECT_LT(exact.mean_error[0], 0.015);
}

TEST(TransferProfileError, ThatOfDiffuseLightThroughAThinSlabIsKnown) {
  const LayerStack stack = slab(0.1, 2.0, 0.9);
  const auto exact =
      transfer_profile(std::vector{stack}, fine_radii, {.illumination = Illumination::diffuse});
  const auto photons = photons_of(stack, {.is_diffuse = true});
  const Coverage t = covered(exact.profile.r, exact.profile.transmittance_profile,
                             exact.transmittance_error, photons.radial.transmission);
  EXPECT_LT(t.worst, 0.07);  // waves: 0.6; the largest where unscattered light ends
  EXPECT_GE(t.share, 0.95);
  EXPECT_LT(exact.mean_error[0], 0.03);
}

TEST(TransferProfileError, ThatOfAThinSlabOnWhiteIsSmall) {
  const LayerStack stack = slab(0.1, 0.5, 0.8, 1.0);
  const auto exact = transfer_profile(std::vector{stack}, fine_radii);
  const auto photons = photons_of(stack, {});
  // Light from the ground that is not scattered ends at total reflection, in a step.
  const double step = 0.1 * std::tan(std::asin(1.0 / 1.4));
  const Coverage r = covered(exact.profile.r, exact.profile.reflectance_profile,
                             exact.relative_error, photons.radial.reflection, step);
  EXPECT_LT(r.worst, 0.02);  // waves: over 1
  EXPECT_GE(r.share, 0.95);
}

TEST(TransferProfileError, ThatOfAnObliqueBeamIsSmallToo) {
  const LayerStack stack = slab(0.2, 3.0, 0.7);
  const double theta = std::numbers::pi / 3.0;
  const auto exact = oblique_profile(std::vector{stack}, theta, fine_radii, 1);
  const auto photons = photons_of(stack, {.theta = theta});
  const double beam = 0.2 * std::tan(std::asin(std::sin(theta) / 1.4));
  const Coverage t = covered(exact.r, exact.transmittance_moments, exact.transmittance_error,
                             photons.radial.transmission, beam);
  EXPECT_LT(t.worst, 0.03);  // waves: 1.07
  EXPECT_GE(t.share, 0.95);
  const Coverage r =
      covered(exact.r, exact.reflectance_moments, exact.estimated_error, photons.radial.reflection);
  EXPECT_LT(r.worst, 0.02);
  EXPECT_GE(r.share, 0.95);
}

// Grazing light in a matched slab stays at its surface: waves come out negative.
TEST(TransferProfileError, GrazingBeamsInMatchedMediaAreLeftToPhotons) {
  const Layer layer{.medium = {.sigma_a = 0.1, .sigma_s = 10.0, .g = 0.8}, .thickness = 1.0};
  for (const double degrees : {89.9999, 89.9999995}) {
    const auto exact = oblique_profile(std::vector{LayerStack({layer})},
                                       degrees * std::numbers::pi / 180.0, fine_radii, 1);
    EXPECT_LT(exact.mean_error[0], 0.2) << degrees;
    EXPECT_TRUE(std::ranges::all_of(exact.reflectance_moments, [](double v) { return v >= 0.0; }));
  }
}

// What is near enough is not called doubtful.
TEST(TransferProfileError, OfHalfSpacesStaysSmall) {
  const Layer skin{.medium = {.sigma_a = 0.05, .sigma_s = 20.0, .g = 0.8, .ior = 1.4},
                   .thickness = std::numeric_limits<double>::infinity()};
  const LayerStack stack({skin}, 1.0, 1.4);
  const auto exact = transfer_profile(std::vector{stack}, fine_radii);
  EXPECT_LT(exact.estimated_error[0], 0.01);
  const auto oblique = oblique_profile(std::vector{stack}, 1.0, fine_radii, 1);
  EXPECT_LT(oblique.largest_error[0], 0.03);
}

// 24 nodes and 13 modes stand for the truth.
TEST(SpatialFrequencyResponse, KnowsItsError) {
  const LayerStack stack = slab(0.2, 3.0, 0.7);
  const std::vector<double> k = {0.0, 1.0, 5.0, 20.0, 60.0};
  const auto rough = spatial_frequency_response(std::vector{stack}, k, {.accuracy = 0.1});
  const auto seen = spatial_frequency_response(std::vector{stack}, k, {.accuracy = 0.002});
  EXPECT_LE(seen.largest_error[0], 0.002);
  EXPECT_LT(seen.largest_error[0], rough.largest_error[0]);
  EXPECT_GT(seen.nodes[0], rough.nodes[0]);
  const auto solver = detail::make_frequency_solver(stack, 24, 13);
  const auto still = detail::response(solver, 0.0);
  const AddingDoublingTotals known = adding_doubling(std::vector{stack}, {}, {.accuracy = 1e-6})[0];
  const double reflected = known.totals.specular_reflectance + known.totals.diffuse_reflectance -
                           known.unscattered_reflectance;
  const double transmitted = known.totals.transmittance - known.unscattered_transmittance;
  EXPECT_NEAR(seen.reflectance[0], reflected, 1e-6);
  EXPECT_NEAR(seen.transmittance[0], transmitted, 1e-6);
  for (std::size_t i = 0; i < k.size(); ++i) {
    const auto truth = detail::response(solver, k[i]);
    EXPECT_NEAR(seen.reflectance[i], truth.reflectance * reflected / still.reflectance,
                seen.reflectance_error[i] + 1e-6);
    EXPECT_NEAR(seen.transmittance[i], truth.transmittance * transmitted / still.transmittance,
                seen.transmittance_error[i] + 1e-6);
    EXPECT_LT(seen.transmittance_error[i], 0.02 * seen.transmittance[i]);
  }
}

}  // namespace
}  // namespace lamina
