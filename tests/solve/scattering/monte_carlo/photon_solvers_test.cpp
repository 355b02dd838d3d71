// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Photon Monte Carlo against the deterministic solver, and in the corners of its domain.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "literal/stack_table.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();

/// Deviations in standard errors, over quantities that photons reach.
struct Deviations {
  double chi_square = 0.0;
  int count = 0;
  void add(const Estimate& estimate, double reference, const std::string& what) {
    if (estimate.standard_error < 1e-7) {
      EXPECT_NEAR(estimate.value, reference, 2e-5) << what;
      return;
    }
    const double deviation = (estimate.value - reference) / estimate.standard_error;
    EXPECT_LT(std::abs(deviation), 4.0) << what << ": " << estimate.value << " ± "
                                        << estimate.standard_error << ", but " << reference;
    chi_square += deviation * deviation;
    ++count;
  }
  /// In standard deviations of the chi-square distribution, as if all were independent.
  [[nodiscard]] double excess() const { return (chi_square - count) / std::sqrt(2.0 * count); }
};

void compare(const MonteCarloResult& result, const SlabTotals& totals, const std::string& name,
             Deviations& deviations) {
  EXPECT_NEAR(result.specular_reflectance.value, totals.specular_reflectance,
              4.0 * result.specular_reflectance.standard_error + 1e-7);
  deviations.add(result.diffuse_reflectance, totals.diffuse_reflectance, name + ", reflectance");
  if (totals.transmittance > 1e-5)
    deviations.add(result.transmittance, totals.transmittance, name + ", transmittance");
  for (std::size_t i = 0; i < totals.absorptance.size(); ++i)
    deviations.add(result.absorptance[i], totals.absorptance[i],
                   name + ", absorptance " + std::to_string(i));
}

// The errors of one stack's totals are correlated (they sum to 1), which widens the distribution of
// chi-square: at most by sqrt(3) for three of them.
TEST(MonteCarlo, TableOfStacksAgreesWithAddingDoubling) {
  Deviations deviations;
  std::uint64_t seed = 1000;  // each stack has its own, so that their errors are independent
  for (const auto& [name, stack] : reference::stack_table()) {
    const MonteCarloResult result = trace_photons(stack, {.photons = 60'000, .seed = ++seed});
    compare(result, adding_doubling(stack).totals, name, deviations);
  }
  EXPECT_GT(deviations.count, 90);
  EXPECT_LT(std::abs(deviations.excess()), 4.0 * std::sqrt(3.0))
      << deviations.chi_square << " over " << deviations.count;
}

TEST(MonteCarlo, ObliqueAndDiffuseLightAgreeWithAddingDoubling) {
  Deviations deviations;
  const auto table = reference::stack_table();
  for (const std::size_t i : {1u, 11u, 13u, 20u, 24u, 27u, 32u})
    for (const Incidence& incidence :
         {Incidence{.theta = 0.6}, Incidence{.theta = 1.3}, Incidence{.is_diffuse = true}}) {
      const MonteCarloResult result =
          trace_photons(table[i].stack, {.photons = 40'000, .seed = 32, .incidence = incidence});
      compare(result, adding_doubling(table[i].stack, incidence).totals, table[i].name, deviations);
    }
  EXPECT_LT(std::abs(deviations.excess()), 4.0 * std::sqrt(3.0));
}

TEST(MonteCarlo, RayleighAndMixturesAgreeWithAddingDoubling) {
  Deviations deviations;
  const PhaseFunction mixture = PhaseMixture{{{.weight = 0.5, .phase = HenyeyGreenstein{0.8}},
                                              {.weight = 0.3, .phase = Rayleigh{}},
                                              {.weight = 0.2, .phase = HenyeyGreenstein{-0.5}}}};
  for (const PhaseFunction& phase : {PhaseFunction(Rayleigh{}), mixture}) {
    const LayerStack stack(
        {{.medium = {.sigma_a = 0.5, .sigma_s = 4.5, .g = mean_cosine(phase), .ior = 1.3},
          .thickness = 0.6,
          .phase = phase},
         {.medium = {.sigma_a = 0.5, .sigma_s = 9.5, .g = 0.3, .ior = 1.4}, .thickness = 0.2}});
    compare(trace_photons(stack, {.photons = 200'000, .seed = 33, .incidence = {.theta = 1.0}}),
            adding_doubling(stack, {.theta = 1.0}).totals, "mixture", deviations);
  }
}

TEST(MonteCarlo, LambertianGroundAgreesWithAddingDoubling) {
  Deviations deviations;
  for (const double below : {1.0, 1.5}) {
    const LayerStack stack(
        {{.medium = {.sigma_a = 0.2, .sigma_s = 3.0, .g = 0.5, .ior = 1.4}, .thickness = 0.5}}, 1.0,
        below, {.reflectance = 0.6});
    compare(trace_photons(stack, {.photons = 200'000, .seed = 34}), adding_doubling(stack).totals,
            "ground", deviations);
  }
}

// Rough boundaries keep all light: nothing is lost where nothing absorbs.
TEST(MonteCarlo, RoughBoundariesKeepTheLight) {
  for (const MicrofacetDistribution distribution :
       {MicrofacetDistribution::beckmann, MicrofacetDistribution::ggx}) {
    const Interface rough = {.roughness = 0.5, .distribution = distribution};
    const LayerStack stack(
        {{.medium = {.sigma_s = 5.0, .ior = 1.5}, .thickness = 0.4, .top = rough},
         {.medium = {.sigma_s = 5.0, .ior = 1.3}, .thickness = 0.4, .top = rough}},
        1.0, 1.0, {.top = rough});
    const MonteCarloResult result = trace_photons(stack, {.photons = 20'000, .seed = 35});
    EXPECT_NEAR(result.specular_reflectance.value + result.diffuse_reflectance.value +
                    result.transmittance.value,
                1.0, 1e-9);
    EXPECT_GT(result.specular_reflectance.value, 0.02);
  }
}

// What facets scatter has a finite radiance: with a rough top all reflected light is in the BRDF.
TEST(MonteCarlo, RoughBoundariesLeaveNothingUnscattered) {
  const Interface rough = {.roughness = 0.4};
  const LayerStack stack({{.medium = {.sigma_s = 1.0, .ior = 1.5}, .thickness = 0.1, .top = rough}},
                         1.0, 1.0);
  const MonteCarloResult result = trace_photons(
      stack, {.photons = 20'000, .seed = 36, .tallies = {.bsdf_cosines = 8, .bsdf_azimuths = 4}});
  EXPECT_EQ(result.unscattered_reflectance.value, 0.0);
  EXPECT_EQ(result.unscattered_transmittance.value, 0.0);
  double reflected = 0.0;
  for (std::size_t cell = 0; cell < result.bsdf.reflection.size(); ++cell)
    reflected += 2.0 * std::numbers::pi / 32 * (static_cast<double>(cell / 4) + 0.5) / 8.0 *
                 result.bsdf.reflection[cell].value;
  EXPECT_NEAR(reflected, result.specular_reflectance.value + result.diffuse_reflectance.value,
              1e-9);
}

TEST(MonteCarlo, SlightRoughnessChangesLittle) {
  const auto stack = [](double roughness) {
    const Interface top = {.roughness = roughness};
    return LayerStack(
        {{.medium = {.sigma_a = 0.5, .sigma_s = 5.0, .ior = 1.4}, .thickness = 1.0, .top = top}},
        1.0, 1.0, {.top = top});
  };
  const MonteCarloResult smooth = trace_photons(stack(0.0), {.photons = 100'000, .seed = 36});
  const MonteCarloResult rough = trace_photons(stack(0.01), {.photons = 100'000, .seed = 37});
  const auto close = [](const Estimate& a, const Estimate& b) {
    EXPECT_NEAR(a.value, b.value, 4.0 * std::hypot(a.standard_error, b.standard_error) + 1e-3);
  };
  close(smooth.diffuse_reflectance, rough.diffuse_reflectance);
  close(smooth.transmittance, rough.transmittance);
}

/// Chandrasekhar's H-function by its integral equation, [Chandrasekhar1960] §39.
double h_function(double albedo, double mu) {
  const Quadrature q = gauss_legendre(64, 0.0, 1.0);
  std::vector<double> h(q.nodes.size(), 1.0);
  const auto evaluate_at = [&](double at) {
    double sum = 0.0;
    for (std::size_t j = 0; j < h.size(); ++j)
      sum += q.weights[j] * q.nodes[j] * h[j] / (at + q.nodes[j]);
    return 1.0 / (std::sqrt(1.0 - albedo) + 0.5 * albedo * sum);
  };
  for (int i = 0; i < 300; ++i) {
    std::vector<double> next;
    for (const double node : q.nodes) next.push_back(evaluate_at(node));
    h = next;
  }
  return evaluate_at(mu);
}

// The BRDF of the isotropic half-space, W H(mu) H(mu0) / (4 pi (mu + mu0)), in single directions.
TEST(NextEventEstimation, FindsChandrasekharsBrdf) {
  const double albedo = 0.8, theta = 0.5;
  const LayerStack stack({{.medium = {.sigma_a = 1.0 - albedo, .sigma_s = albedo}}});
  const std::vector<ExitDirection> directions = {
      {.theta = 0.0}, {.theta = 0.9, .phi = 2.0}, {.theta = 1.4}};
  const MonteCarloResult result = trace_photons(stack, {.photons = 200'000,
                                                        .seed = 38,
                                                        .incidence = {.theta = theta},
                                                        .tallies = {.directions = directions}});
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double mu = std::cos(directions[i].theta), mu0 = std::cos(theta);
    const double expected =
        albedo / (4.0 * pi) * h_function(albedo, mu) * h_function(albedo, mu0) / (mu + mu0);
    EXPECT_NEAR(result.directions[i].value, expected, 4.0 * result.directions[i].standard_error);
    EXPECT_LT(result.directions[i].standard_error, 0.005 * expected);
  }
}

// Against the photons that leave, through boundaries that reflect on both sides and inside: the
// estimate in the middle of a cell that is small.
TEST(NextEventEstimation, AgreesWithThePhotonsThatLeave) {
  const LayerStack stack(
      {{.medium = {.sigma_a = 0.5, .sigma_s = 4.0, .g = 0.6, .ior = 1.5}, .thickness = 0.2},
       {.medium = {.sigma_a = 0.2, .sigma_s = 6.0, .g = -0.2, .ior = 1.3}, .thickness = 0.3}},
      1.0, 1.2);
  constexpr int rows = 12, columns = 12;
  std::vector<ExitDirection> directions;
  const auto middle = [](int i) { return (i + 0.5) / 12.0; };
  for (const bool below : {false, true})
    for (const int row : {4, 7, 11})
      for (const int column : {0, 5})
        directions.push_back(
            {.theta = std::acos(middle(row)), .phi = 2.0 * pi * middle(column), .is_below = below});
  const MonteCarloResult result = trace_photons(
      stack,
      {.photons = 1'500'000,
       .seed = 39,
       .incidence = {.theta = 0.8},
       .tallies = {.bsdf_cosines = rows, .bsdf_azimuths = columns, .directions = directions}});
  std::size_t i = 0;
  for (const bool below : {false, true})
    for (const int row : {4, 7, 11})
      for (const int column : {0, 5}) {
        const Estimate& cell =
            (below ? result.bsdf.transmission
                   : result.bsdf.reflection)[static_cast<std::size_t>(row * columns + column)];
        const Estimate& view = result.directions[i++];
        // 1 % for the curvature of the BSDF in the cell.
        EXPECT_NEAR(view.value, cell.value,
                    4.0 * std::hypot(view.standard_error, cell.standard_error) + 0.01 * cell.value)
            << below << ' ' << row << ' ' << column;
        EXPECT_LT(view.standard_error, 0.02 * view.value);
      }
}

TEST(NextEventEstimation, SeesALambertianGroundThroughClearAir) {
  // BRDF rho / pi, and nothing else.
  const LayerStack stack({{.medium = {.ior = 1.0}, .thickness = 1.0}}, 1.0, 1.0,
                         {.reflectance = 0.5});
  const MonteCarloResult result = trace_photons(
      stack, {.photons = 50'000, .seed = 40, .tallies = {.directions = {{.theta = 0.7}}}});
  EXPECT_NEAR(result.directions[0].value, 0.5 / pi, 4.0 * result.directions[0].standard_error);
  EXPECT_NEAR(result.diffuse_reflectance.value, 0.5,
              4.0 * result.diffuse_reflectance.standard_error);
}

// Mean of r over the light that passes a clear matched slab, straight down.
TEST(MonteCarlo, BeamsHaveTheirShapes) {
  const LayerStack stack({{.medium = {.ior = 1.0}, .thickness = 1.0}});
  const auto inside = [&](Beam::Shape shape, double r) {  // fraction within r
    const MonteCarloResult result = trace_photons(stack, {.photons = 100'000,
                                                          .seed = 41,
                                                          .beam = {.shape = shape, .radius = 2.0},
                                                          .tallies = {.r = {2, r}}});
    return result.radial.transmission[0].value * pi * r * r;
  };
  EXPECT_NEAR(inside(Beam::Shape::flat, 1.0), 0.25, 0.006);  // 4 standard errors
  EXPECT_NEAR(inside(Beam::Shape::flat, 2.01), 1.0, 1e-9);
  EXPECT_NEAR(inside(Beam::Shape::gaussian, 2.0), 1.0 - std::exp(-2.0), 0.005);
  EXPECT_NEAR(inside(Beam::Shape::pencil, 0.01), 1.0, 1e-9);
}

TEST(MonteCarlo, EndlessScatteringIsCutAndReported) {
  const LayerStack stack({{.medium = {.sigma_s = 10.0}}});
  const MonteCarloResult result =
      trace_photons(stack, {.photons = 20'000, .seed = 42, .max_events = 2'000});
  EXPECT_GT(result.unfinished.value, 0.002);  // about 1 / sqrt(events)
  EXPECT_LT(result.unfinished.value, 0.05);
  EXPECT_NEAR(result.diffuse_reflectance.value + result.unfinished.value, 1.0, 1e-6);
}

TEST(MonteCarlo, LightTotallyReflectedOutsideNeverEnters) {
  const LayerStack stack({{.medium = {.sigma_a = 1.0}, .thickness = 1.0}}, 1.5);
  const MonteCarloResult result =
      trace_photons(stack, {.photons = 1000, .seed = 43, .incidence = {.theta = 1.2}});
  EXPECT_EQ(result.specular_reflectance.value, 1.0);
  EXPECT_EQ(result.absorptance[0].value, 0.0);
}

// A clear half-space below takes the light and never gives it back; it counts as transmitted.
TEST(MonteCarlo, ClearHalfSpaceTransmits) {
  const LayerStack stack({{.medium = {.sigma_a = 1.0, .ior = 1.0}, .thickness = 1.0},
                          {.medium = {.ior = 1.5}, .thickness = infinite}});
  const MonteCarloResult result = trace_photons(stack, {.photons = 100'000, .seed = 44});
  const double f = fresnel(1.0, 1.5);
  EXPECT_NEAR(result.transmittance.value, std::exp(-1.0) * (1.0 - f),
              4.0 * result.transmittance.standard_error);
}

TEST(MonteCarlo, StopsAtThePrecisionAskedWhateverTheThreads) {
  const LayerStack stack = reference::stack_table()[0].stack;
  const MonteCarloOptions options = {.photons = 100'000'000, .seed = 45, .relative_error = 0.01};
  const MonteCarloResult result = trace_photons(stack, options);
  EXPECT_LE(result.diffuse_reflectance.standard_error, 0.01 * result.diffuse_reflectance.value);
  EXPECT_LT(result.photons, 20'000'000u);
  EXPECT_FALSE(result.was_stopped);
}

TEST(MonteCarlo, StopsAtTheTimeAskedAndWhenTold) {
  const LayerStack stack = reference::stack_table()[0].stack;
  const auto start = std::chrono::steady_clock::now();
  const MonteCarloResult timed =
      trace_photons(stack, {.photons = 1'000'000'000'000, .seed = 46, .seconds = 0.2});
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 5.0);
  EXPECT_TRUE(timed.was_stopped);
  EXPECT_GT(timed.photons, 0u);
  EXPECT_NEAR(timed.diffuse_reflectance.value, 0.0973946,
              4.0 * timed.diffuse_reflectance.standard_error);
  int asked = 0;
  const MonteCarloResult told = trace_photons(
      stack,
      {.photons = 1'000'000'000'000, .seed = 46, .progress = [&](double) { return ++asked < 3; }});
  EXPECT_TRUE(told.was_stopped);
  EXPECT_GT(told.photons, 0u);
}

}  // namespace
}  // namespace lamina
