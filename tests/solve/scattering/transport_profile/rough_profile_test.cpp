// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Profiles by radiative transfer where boundaries are rough.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"
#include "lamina/solve/scattering/spatial_frequency/rough_inside.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"
#include "literal/spectral_reflection.h"

namespace lamina {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

Layer layer(double sigma_a, double sigma_s, double g, double ior, double thickness,
            double roughness = 0.0) {
  return {.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
          .thickness = thickness,
          .top = {.roughness = roughness}};
}

LayerStack half_space(double roughness) {
  return LayerStack({layer(1.0, 9.0, 0.0, 1.5, infinite, roughness)}, 1.0, 1.5);
}

LayerStack skin(double roughness) {
  return LayerStack(
      {layer(1.0, 20.0, 0.8, 1.4, 0.1, roughness), layer(0.2, 10.0, 0.6, 1.34, infinite)}, 1.0,
      1.34);
}

LayerStack thin_slab(double roughness) {
  return LayerStack({layer(0.5, 4.5, 0.5, 1.4, 0.2, roughness)});
}

// A boundary is local: without waves the solver is adding-doubling with the same operators.
TEST(RoughProfile, WithoutWavesIsAddingDoublingOnTheSameGrid) {
  for (const LayerStack& stack : {half_space(0.4), skin(0.7), thin_slab(1.0)}) {
    const auto solver = detail::make_frequency_solver(stack, 8, 3);
    const auto operators = detail::stack_operators(solver.stack, 0, solver.rough[0]);
    const DirectionGrid& grid = solver.stack.grid;
    const std::size_t beam = grid.extra[0];
    const auto flux_of_beam = [&](const detail::Matrix& matrix) {
      double flux = 0.0;
      for (std::size_t i = 0; i < matrix.rows; ++i)
        if (i != beam) flux += std::sqrt(grid.etendue[i] / grid.etendue[beam]) * matrix(i, beam);
      return flux;
    };
    EXPECT_NEAR(detail::response(solver, 0.0).reflectance,
                flux_of_beam(operators.reflection) - flux_of_beam(operators.first_reflection),
                1e-9);
  }
}

// Waves couple even and odd modes, which a rough boundary keeps apart. The lattice of facets is not
// quite reciprocal by itself: what the waves add must be.
TEST(RoughProfile, WavesRetraceTheirWay) {
  const auto solver = detail::make_frequency_solver(skin(0.5), 8, 5);
  double of_boundary = 0.0;
  for (const auto& mode : solver.rough) {
    const detail::Matrix& m = mode[0].reflection_above;
    for (std::size_t i = 0; i < m.rows; ++i)
      for (std::size_t j = 0; j < m.columns; ++j)
        of_boundary = std::max(of_boundary, std::abs(m(i, j) - m(j, i)));
  }
  EXPECT_LT(of_boundary, 2e-3);
  for (const double k : {0.5, 20.0}) {
    const auto reflection = reference::spectral_reflection(solver, k);
    const detail::Matrix& m = reflection.matrix;
    double off = 0.0, between_parities = 0.0;
    for (std::size_t i = 0; i < m.rows; ++i)
      for (std::size_t j = 0; j < m.columns; ++j) {
        const bool is_odd = (reflection.mode[i] + reflection.mode[j]) % 2 != 0;
        off = std::max(off, std::abs(m(i, j) - (is_odd ? -1.0 : 1.0) * m(j, i)));
        if (is_odd) between_parities = std::max(between_parities, std::abs(m(i, j)));
      }
    EXPECT_LT(off, 1.2 * of_boundary) << "k " << k;
    EXPECT_GT(between_parities, 4.0 * of_boundary) << "k " << k;
  }
}

/// Rings of .02 mm by photons against the profile; chi2 per ring.
struct Rings {
  double chi2 = 0.0, worst = 0.0;
};
Rings compare(const std::vector<Estimate>& photons, const Profile& profile, bool is_reflectance) {
  constexpr double ring = 0.02;
  const Quadrature rule = gauss_legendre(8, 0.0, 1.0);
  Rings rings;
  // The first ring has the point of entry, the last one all light beyond.
  for (std::size_t i = 1; i + 1 < photons.size(); ++i) {
    const double inner = static_cast<double>(i) * ring;
    double mean = 0.0;
    for (std::size_t q = 0; q < 8; ++q) {
      const double r = inner + ring * rule.nodes[q];
      mean += rule.weights[q] * 2.0 * r / (2.0 * inner + ring) *
              (is_reflectance ? reflectance_profile(profile, r, 0)
                              : transmittance_profile(profile, r, 0));
    }
    const double sigma = std::hypot(photons[i].standard_error, 0.005 * mean);
    const double z = (photons[i].value - mean) / sigma;
    rings.chi2 += z * z / static_cast<double>(photons.size() - 2);
    rings.worst = std::max(rings.worst, std::abs(z));
  }
  return rings;
}

TEST(RoughProfile, AgreesWithPhotonsRingByRing) {
  struct Case {
    std::string name;
    LayerStack stack;
    double error;  ///< estimated, at most
    bool is_diffuse = false;
  };
  for (const Case& c :
       {Case{"half-space .05", half_space(0.05), 0.01},
        Case{"half-space 1", half_space(1.0), 0.005}, Case{"skin .4", skin(0.4), 0.005},
        Case{"thin slab 1", thin_slab(1.0), 0.03},
        Case{"half-space .5, diffuse", half_space(0.5), 0.005, true}}) {
    MonteCarloOptions options{
        .photons = 400'000, .seed = 3, .incidence = {.is_diffuse = c.is_diffuse}};
    options.tallies.r = {.count = 20, .width = 0.02};
    const MonteCarloResult photons = trace_photons(c.stack, options);
    const TransferProfile solved = transfer_profile(
        std::vector{c.stack}, {.first = 1e-4, .last = 20.0, .size = 160},
        {.r_highest = 0.4,
         .illumination = c.is_diffuse ? Illumination::diffuse : Illumination::normal_beam});
    EXPECT_LT(solved.estimated_error[0], c.error) << c.name;
    const Rings reflected = compare(photons.radial.reflection, solved.profile, true);
    EXPECT_LT(reflected.chi2, 1.6) << c.name;
    EXPECT_LT(reflected.worst, 4.5) << c.name;
    EXPECT_NEAR(solved.profile.total_reflectance[0], photons.diffuse_reflectance.value,
                4.0 * photons.diffuse_reflectance.standard_error)
        << c.name;
    if (is_semi_infinite(c.stack)) continue;
    const Rings transmitted = compare(photons.radial.transmission, solved.profile, false);
    EXPECT_LT(transmitted.chi2, 2.0) << c.name;
    EXPECT_LT(transmitted.worst, 4.5) << c.name;
  }
}

// Light that total reflection sends to the top from inside remembers its azimuth there: with mode 0
// of the boundary in place of all modes R at 2 /mm is wrong by 3 %.
TEST(RoughProfile, AgreesWithPhotonsAtSpatialFrequencies) {
  const LayerStack slab({layer(0.1, 5.0, 0.8, 1.8, 0.2, 0.6)});
  constexpr double ring = 0.002;
  MonteCarloOptions options{.photons = 1'000'000, .seed = 3};
  options.tallies.r = {.count = 4000, .width = ring};
  const MonteCarloResult photons = trace_photons(slab, options);
  const auto solver = detail::make_frequency_solver(slab, 14, 7);
  const auto expect = [](double value, const std::vector<Estimate>& rings, double k) {
    double sum = 0.0, variance = 0.0;
    for (std::size_t i = 0; i + 1 < rings.size(); ++i) {  // the last ring has all light beyond
      const double r = (static_cast<double>(i) + 0.5) * ring;
      const double wave = 2.0 * std::numbers::pi * r * ring * std::cyl_bessel_j(0.0, k * r);
      sum += wave * rings[i].value;
      variance += std::pow(wave * rings[i].standard_error, 2);
    }
    EXPECT_NEAR(value, sum, 3.5 * std::sqrt(variance)) << "k " << k;
  };
  for (const double k : {2.0, 5.0}) {
    const detail::FrequencyResponse solved = detail::response(solver, k);
    expect(solved.reflectance, photons.radial.reflection, k);
    expect(solved.transmittance, photons.radial.transmission, k);
  }
}

TEST(RoughProfile, HardlyRoughIsSmooth) {
  const std::vector<LayerStack> smooth{half_space(0.0)}, rough{half_space(0.005)};
  const RadialGrid radii{.first = 1e-3, .last = 20.0, .size = 120};
  const TransferProfileOptions fine{.accuracy = 0.001, .r_highest = 0.6};
  const TransferProfile a = transfer_profile(smooth, radii, fine);
  const TransferProfile b = transfer_profile(rough, radii, fine);
  for (std::size_t i = 0; i < a.profile.r.size(); ++i) {
    if (a.profile.r[i] < 0.01 || a.profile.r[i] > 0.6) continue;
    const double allowed = a.relative_error[i] + b.relative_error[i] + 2e-3;
    EXPECT_NEAR(b.profile.reflectance_profile[i] / a.profile.reflectance_profile[i], 1.0, allowed)
        << "r " << a.profile.r[i];
  }
}

TEST(RoughProfile, RingsAddUpToTheTotalOfAddingDoubling) {
  const LayerStack stack = half_space(0.6);
  const TransferProfile solved =
      transfer_profile(std::vector{stack}, {.first = 1e-5, .last = 100.0, .size = 256});
  const Profile& profile = solved.profile;
  double sum = 0.0;  // over log r
  for (std::size_t i = 1; i < profile.r.size(); ++i) {
    const auto ring = [&](std::size_t k) {
      return 2.0 * std::numbers::pi * profile.r[k] * profile.r[k] * profile.reflectance_profile[k];
    };
    sum += 0.5 * (ring(i - 1) + ring(i)) * std::log(profile.r[i] / profile.r[i - 1]);
  }
  EXPECT_NEAR(sum / profile.total_reflectance[0], 1.0, 2e-3);
  EXPECT_NEAR(profile.total_reflectance[0], adding_doubling(stack).totals.diffuse_reflectance,
              2e-4);
}

LayerStack rough_inside(double roughness) {
  return LayerStack(
      {layer(1.0, 20.0, 0.8, 1.4, 0.1), layer(0.2, 10.0, 0.6, 1.34, infinite, roughness)}, 1.0,
      1.34);
}

LayerStack frosted_below(double roughness) {
  return LayerStack({layer(0.5, 4.5, 0.5, 1.4, 0.2)}, 1.0, 1.0, {.top = {.roughness = roughness}});
}

TEST(RoughProfile, AgreesWithPhotonsWhereTheBottomIsRough) {
  const LayerStack stack = frosted_below(0.4);
  MonteCarloOptions options{.photons = 100'000, .seed = 3};
  options.tallies.r = {.count = 20, .width = 0.02};
  const MonteCarloResult photons = trace_photons(stack, options);
  const TransferProfile solved =
      transfer_profile(std::vector{stack}, {.first = 1e-3, .last = 20.0, .size = 120},
                       {.accuracy = 0.02, .r_highest = 0.4});
  EXPECT_LT(solved.estimated_error[0], 0.07);
  for (const bool is_reflectance : {true, false}) {
    const Rings rings =
        compare(is_reflectance ? photons.radial.reflection : photons.radial.transmission,
                solved.profile, is_reflectance);
    EXPECT_LT(rings.chi2, 2.0);
    EXPECT_LT(rings.worst, 4.5);
  }
}

// Waves alone: photons' rings as a wave.
TEST(RoughProfile, AgreesWithPhotonsAtSpatialFrequenciesWhereABoundaryInsideIsRough) {
  const LayerStack stack = rough_inside(0.4);
  MonteCarloOptions options{.photons = 200'000, .seed = 3};
  constexpr double ring = 0.005;
  options.tallies.r = {.count = 4000, .width = ring};
  const MonteCarloResult photons = trace_photons(stack, options);
  const auto solver = detail::make_frequency_solver(stack, 10, 5);
  for (const double k : {1.0, 5.0}) {
    double sum = 0.0, variance = 0.0;
    for (std::size_t i = 0; i + 1 < photons.radial.reflection.size(); ++i) {
      const double r = (static_cast<double>(i) + 0.5) * ring;
      const double wave = 2.0 * std::numbers::pi * r * ring * std::cyl_bessel_j(0.0, k * r);
      sum += wave * photons.radial.reflection[i].value;
      variance += std::pow(wave * photons.radial.reflection[i].standard_error, 2);
    }
    EXPECT_NEAR(detail::response(solver, k).reflectance, sum, 3.5 * std::sqrt(variance))
        << "k " << k;
  }
}

TEST(RoughProfile, LightOfLowOrdersEndsAtTheFirstRoughBoundaryInside) {
  const LayerStack stack({layer(1.0, 20.0, 0.8, 1.4, 0.1, 0.5), layer(0.2, 10.0, 0.6, 1.3, 0.2),
                          layer(0.2, 10.0, 0.6, 1.5, 0.3, 0.4)},
                         1.0, 1.2, {.reflectance = 0.5});
  const auto whole = detail::make_grid_stack(stack, 4, {});
  const auto upper = detail::above_rough_inside(whole);
  EXPECT_EQ(upper.layers.size(), 2u);
  EXPECT_EQ(upper.ior, (std::vector{1.0, 1.4, 1.3, 1.3}));
  EXPECT_EQ(upper.interfaces, (std::vector{whole.interfaces[0], whole.interfaces[1], Interface{}}));
  EXPECT_TRUE(upper.is_semi_infinite);
  EXPECT_EQ(upper.ground_reflectance, 0.0);
  EXPECT_EQ(detail::above_rough_inside(upper).layers.size(), 2u);
}

TEST(RoughProfile, HardlyRoughInsideIsSmooth) {
  const std::vector<double> k{0.3, 3.0, 20.0};
  const auto smooth = detail::responses(detail::make_frequency_solver(rough_inside(0.0), 8, 4), k);
  const auto rough = detail::responses(detail::make_frequency_solver(rough_inside(0.005), 8, 4), k);
  for (std::size_t i = 0; i < k.size(); ++i)
    EXPECT_NEAR(rough[i].reflectance / smooth[i].reflectance, 1.0, 2e-3) << "k " << k[i];
}

// Light that crosses a rough bottom unscattered leaves at the axis: all that is left of T where
// waves are short, and what photons count within a nanometre.
TEST(RoughProfile, OfARoughBottomTheAxisIsKnown) {
  const LayerStack stack({layer(0.5, 4.5, 0.0, 1.4, 0.2)}, 1.0, 1.2,
                         {.top = {.roughness = 0.4}, .reflectance = 0.3});
  const auto solver = detail::make_frequency_solver(stack, 12, 3);
  const double axis = detail::through_rough_bottom(solver, detail::Unscattered::by_medium);
  EXPECT_NEAR(detail::response(solver, 3000.0).transmittance, axis, 1e-3 * axis);
  MonteCarloOptions options{.photons = 100'000, .seed = 9};
  options.tallies.log_r = {.count = 1, .low = 1e-6, .high = 1.0};
  const Estimate seen = trace_photons(stack, options).log_radial_outside.transmission[0];
  EXPECT_NEAR(axis, seen.value, 4.0 * seen.standard_error);
  EXPECT_EQ(detail::through_rough_bottom(detail::make_frequency_solver(thin_slab(0.4), 6, 1),
                                         detail::Unscattered::by_medium),
            0.0);
}

}  // namespace
}  // namespace lamina
