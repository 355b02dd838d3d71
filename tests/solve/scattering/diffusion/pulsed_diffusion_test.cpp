// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/pulsed_diffusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/speed_of_light.h"
#include "lamina/solve/scattering/diffusion/pulsed_dipole.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace lamina {
namespace {

using std::numbers::pi;

const Layer tissue{.medium = {.sigma_a = 0.01, .sigma_s = 5.0, .g = 0.8, .ior = 1.4}};

// [KienlePatterson1997] print 0.118 and 0.306 for index 1.4; A of matched indices is 1.
TEST(EscapeWeights, AreThosePrintedForTissue) {
  const EscapeWeights tissue_to_air = make_escape_weights({}, 1.4, 1.0);
  EXPECT_NEAR(tissue_to_air.fluence, 0.118, 5e-4);
  EXPECT_NEAR(tissue_to_air.flux, 0.306, 5e-4);
  const EscapeWeights matched = make_escape_weights({}, 1.33, 1.33);
  EXPECT_NEAR(matched.fluence_ratio(), 1.0, 1e-12);
  EXPECT_NEAR(matched.flux, 0.5, 1e-12);
}

// The pulse solves the diffusion equation: over time it adds up to the steady source and image,
// whose flux is [KienlePatterson1997]'s closed form.
TEST(PulsedDipole, AddsUpToTheSteadyDipole) {
  const PulsedDipole pulse = make_pulsed_dipole(tissue, 1.0);
  const double kappa = std::sqrt(pulse.sigma_a / pulse.D);
  for (const double r : {2.0, 10.0}) {
    const auto flux_of = [&](double z) {
      const double d = std::hypot(r, z);
      return z * (kappa + 1.0 / d) * std::exp(-kappa * d) / (4.0 * pi * d * d);
    };
    const auto fluence_of = [&](double z) {
      const double d = std::hypot(r, z);
      return std::exp(-kappa * d) / (4.0 * pi * pulse.D * d);
    };
    const double steady =
        pulse.escape.fluence * (fluence_of(pulse.source_depth) - fluence_of(pulse.image_height)) +
        pulse.escape.flux * (flux_of(pulse.source_depth) + flux_of(pulse.image_height));
    const double sum = integrate(
        [&](double log_t) {
          return std::exp(log_t) * pulsed_reflectance(pulse, r, std::exp(log_t));
        },
        std::log(0.1), std::log(1e6), 1e-12);
    EXPECT_NEAR(sum / steady, 1.0, 1e-6);
  }
}

// The half-space by transforms is its closed form; one cut into layers of its own is, too.
TEST(PulsedDiffusion, LayersOfOneMediumAreTheHalfSpace) {
  const std::vector<double> r = {1.0, 5.0, 20.0}, t = {60, 150, 300, 600, 1500, 3000};
  Layer slice = tissue;
  slice.thickness = 0.4;
  for (const LayerStack& stack :
       {LayerStack({tissue}, 1.0, 1.4), LayerStack({slice, slice, slice, tissue}, 1.0, 1.4)}) {
    const auto closed = pulsed_diffusion(LayerStack({tissue}, 1.0, 1.4), r, t);
    const auto found = pulsed_diffusion_by_transforms(stack, r, t);
    for (std::size_t d = 0; d < r.size(); ++d)
      for (std::size_t j = 0; j < t.size(); ++j)
        if (t[j] > 0.8 * r[d] * 1.4 / speed_of_light) {
          EXPECT_NEAR(found[d][j] / closed[d][j], 1.0, 1e-4) << r[d] << " mm " << t[j] << " ps";
        }
  }
}

// [Contini1997] Eq. 36: what a slab reflects, by its images; two layers of other indices whose
// optical paths and n² compensate are out of its reach, and are left to photons.
TEST(PulsedDiffusion, SlabIsItsImages) {
  Layer slab = tissue;
  slab.thickness = 8.0;
  const LayerStack stack({slab}, 1.4, 1.4);  // matched: A = 1
  const std::vector<double> r = {6.0}, t = {100, 300, 900};
  const auto found = pulsed_diffusion(stack, r, t);
  const double D = 1.0 / 3.0, v = speed_of_light / 1.4, z_e = 2.0 * D, z_s = 1.0;
  for (std::size_t j = 0; j < t.size(); ++j) {
    const double spread = 4.0 * D * v * t[j];
    double fluence = 0.0, flux = 0.0;
    for (int m = -30; m <= 30; ++m) {
      const double above = 2.0 * m * (8.0 + 2.0 * z_e) + z_s;
      const double below = 2.0 * m * (8.0 + 2.0 * z_e) - 2.0 * z_e - z_s;
      const double a = std::exp(-above * above / spread), b = std::exp(-below * below / spread);
      fluence += a - b;
      flux += above * a - below * b;
    }
    const double common =
        std::exp(-r[0] * r[0] / spread - 0.01 * v * t[j]) / std::pow(pi * spread, 1.5);
    const double expected = common * (0.25 * v * fluence + 0.5 * flux / (2.0 * t[j]));
    // The lower side leaks by Robin's condition here, by a plane without fluence there.
    EXPECT_NEAR(found[0][j] / expected, 1.0, j == 0 ? 1e-3 : 0.02) << t[j];
  }
}

/// Light of late photons within rings, over what diffusion makes of it there, and its error.
Estimate photons_over_diffusion(const LayerStack& stack, double first, double last) {
  MonteCarloOptions options{.photons = 300'000, .seed = 3};
  options.tallies = {.time = {20, 60.0}, .detectors = {6.0}, .detector_width = 8.0};
  const MonteCarloResult photons = trace_photons(stack, options);
  double found = 0.0, error = 0.0;
  for (auto bin = static_cast<std::size_t>(first / 60.0); 60.0 * static_cast<double>(bin) < last;
       ++bin) {
    found += 60.0 * photons.detector_time[bin].value;
    error = std::hypot(error, 60.0 * photons.detector_time[bin].standard_error);
  }
  const Quadrature radii = gauss_legendre(8, 2.0, 10.0), times = gauss_legendre(16, first, last);
  const auto values = pulsed_diffusion(stack, radii.nodes, times.nodes);
  double expected = 0.0;
  for (std::size_t i = 0; i < radii.nodes.size(); ++i)
    for (std::size_t j = 0; j < times.nodes.size(); ++j)
      expected += radii.weights[i] * radii.nodes[i] * times.weights[j] * values[i][j] / 48.0;
  return {found / expected, error / expected};
}

// Photons of late times: diffusion is known to be right to a few percent.
TEST(PulsedDiffusion, MeetsPhotonsAtLateTimes) {
  const LayerStack half_space({tissue}, 1.0, 1.4);
  for (const auto& [first, last] : {std::pair{240.0, 480.0}, std::pair{480.0, 960.0}}) {
    const Estimate over = photons_over_diffusion(half_space, first, last);
    EXPECT_NEAR(over.value, 1.0, 4.0 * over.standard_error + 0.01);
    EXPECT_LT(over.standard_error, 0.02);
  }
}

// Layers of different indices, scattering and absorption.
TEST(PulsedDiffusion, LayersMeetPhotonsAtLateTimes) {
  const LayerStack layers(
      {{.medium = {.sigma_a = 0.02, .sigma_s = 5.0, .g = 0.8, .ior = 1.35}, .thickness = 3.0},
       {.medium = {.sigma_a = 0.005, .sigma_s = 3.0, .g = 0.8, .ior = 1.5}}},
      1.0, 1.5);
  for (const auto& [first, last] : {std::pair{240.0, 480.0}, std::pair{480.0, 960.0}}) {
    const Estimate over = photons_over_diffusion(layers, first, last);
    EXPECT_NEAR(over.value, 1.0, 4.0 * over.standard_error + 0.01);
    EXPECT_LT(over.standard_error, 0.015);
  }
}

TEST(PulsedDiffusion, RefusesLayersThatDoNotScatter) {
  const LayerStack stack({{.medium = {.sigma_a = 0.1, .ior = 1.5}, .thickness = 1.0}, tissue}, 1.0,
                         1.4);
  const std::vector<double> one = {1.0};
  EXPECT_THROW((void)pulsed_diffusion(stack, one, one), InvalidInput);
}

}  // namespace
}  // namespace lamina
