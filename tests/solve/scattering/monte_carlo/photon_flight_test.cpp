// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Time of flight of photons, and light that is modulated in time.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/layers/optics/speed_of_light.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/adding_doubling_derivatives.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;

const LayerStack two_layers(
    {{.medium = {.sigma_a = 0.1, .sigma_s = 5.0, .g = 0.6, .ior = 1.5}, .thickness = 0.5},
     {.medium = {.sigma_a = 0.03, .sigma_s = 10.0, .g = 0.8, .ior = 1.33}, .thickness = 2.0}});

MonteCarloResult flight_of(const LayerStack& stack, std::uint64_t photons) {
  MonteCarloOptions options{.photons = photons, .seed = 31};
  options.tallies = {.r = {6, 0.7},
                     .mean_path_length = true,
                     .time = {400, 1.0},
                     .frequencies = {0.0, 200.0, 1500.0},
                     .detectors = {1.0, 2.0},
                     .detector_width = 1.0};
  return trace_photons(stack, options);
}

// The same light cut over radius and time, and times what modulation makes of it.
TEST(PhotonFlight, GridsAreTheSameLight) {
  const MonteCarloResult result = flight_of(two_layers, 20'000);
  for (const bool below : {false, true}) {
    const auto pick = [&](const auto& both) { return below ? both.transmission : both.reflection; };
    const Estimate& total = below ? result.transmittance : result.diffuse_reflectance;
    double sum = 0.0;
    for (const Estimate& e : pick(result.time)) sum += e.value;
    EXPECT_NEAR(sum, total.value, 1e-9);
    for (std::size_t ring = 0; ring < 6; ++ring) {
      double over_time = 0.0;
      for (std::size_t i = 0; i < 400; ++i)
        over_time += pick(result.radial_time)[ring * 400 + i].value;
      EXPECT_NEAR(over_time, pick(result.radial)[ring].value, 1e-9);
      EXPECT_NEAR(pick(result.radial_modulation)[ring * 3].amplitude.value, over_time, 1e-9);
      EXPECT_EQ(pick(result.radial_modulation)[ring * 3].phase.value, 0.0);
    }
    EXPECT_NEAR(pick(result.modulation)[0].amplitude.value, total.value, 1e-9);
    EXPECT_NEAR(pick(result.modulation)[0].amplitude.standard_error, total.standard_error,
                0.02 * total.standard_error);
    // Modulated light is the Fourier integral over time, to what bins of 1 ps lose.
    for (std::size_t f = 1; f < 3; ++f) {
      const double omega = 2e-6 * pi * (f == 1 ? 200.0 : 1500.0);
      double c = 0.0, s = 0.0;
      for (std::size_t i = 0; i + 1 < 400; ++i) {
        const double t = static_cast<double>(i) + 0.5;
        c += std::cos(omega * t) * pick(result.time)[i].value;
        s += std::sin(omega * t) * pick(result.time)[i].value;
      }
      const Modulation& found = pick(result.modulation)[f];
      EXPECT_NEAR(found.amplitude.value, std::hypot(c, s), 2e-3 * total.value);
      EXPECT_NEAR(found.phase.value, std::atan2(s, c), 3e-3);
    }
  }
  for (std::size_t d = 0; d < 2; ++d) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 400; ++i) sum += result.detector_time[d * 400 + i].value;
    EXPECT_NEAR(sum, result.detectors[d].value, 1e-9);
    EXPECT_NEAR(result.detector_modulation[d * 3].amplitude.value, sum, 1e-9);
  }
}

// Mean paths in each layer are what absorption there takes: -d ln R / d sigma_a, by
// adding-doubling's derivatives; the mean time is that of these paths at c / n.
TEST(PhotonFlight, MeanPathsAreTheLogarithmicDerivativesByAbsorption) {
  const MonteCarloResult result = flight_of(two_layers, 400'000);
  const AddingDoublingDerivatives exact = adding_doubling_derivatives(two_layers);
  for (const bool below : {false, true}) {
    const auto& paths =
        below ? result.mean_layer_path.transmission : result.mean_layer_path.reflection;
    const auto& by = below ? exact.transmittance : exact.diffuse_reflectance;
    const double light =
        below ? exact.totals.totals.transmittance : exact.totals.totals.diffuse_reflectance;
    double time = 0.0, path = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
      const double expected = -by[k].by_sigma_a / light;
      EXPECT_NEAR(paths[k].value, expected, 4.0 * paths[k].standard_error) << below << k;
      EXPECT_LT(paths[k].standard_error, 0.01 * expected);
      time += two_layers.layers()[k].medium.ior * expected / speed_of_light;
      path += paths[k].value;
    }
    const Estimate& mean = below ? result.mean_time_transmitted : result.mean_time_reflected;
    EXPECT_NEAR(mean.value, time, 4.0 * mean.standard_error);
    EXPECT_LT(mean.standard_error, 0.01 * time);
    EXPECT_NEAR(path, (below ? result.mean_path_transmitted : result.mean_path_reflected).value,
                1e-5 * path);
  }
}

// A ground sends light back without time: straight light to it and back crosses a layer twice.
TEST(PhotonFlight, StraightLightTakesItsThickness) {
  const LayerStack stack({{.medium = {.sigma_a = 0.1, .ior = 1.4}, .thickness = 3.0}}, 1.4, 1.4);
  MonteCarloOptions options{.photons = 1000};
  options.tallies = {.time = {10, 10.0}, .frequencies = {500.0}};
  const MonteCarloResult result = trace_photons(stack, options);
  const double time = 3.0 * 1.4 / speed_of_light;  // 14.01 ps
  EXPECT_NEAR(result.mean_time_transmitted.value, time, 1e-4 * time);
  EXPECT_NEAR(10.0 * result.time.transmission[1].value, std::exp(-0.3), 0.05);
  EXPECT_EQ(result.time.transmission[2].value, 0.0);
  EXPECT_NEAR(result.modulation.transmission[0].phase.value, 2e-6 * pi * 500.0 * time, 1e-6);
  EXPECT_EQ(result.modulation.reflection[0].amplitude.value, 0.0);
  EXPECT_EQ(result.modulation.reflection[0].phase.standard_error, pi);
}

// Amplitudes and phases of many runs scatter as each of them says.
TEST(PhotonFlight, ErrorsOfModulationAreItsScatter) {
  constexpr int runs = 150;
  double mean[2] = {}, squares[2] = {}, expected[2] = {};
  for (int run = 0; run < runs; ++run) {
    MonteCarloOptions options{.photons = 1000, .seed = 500 + static_cast<std::uint64_t>(run)};
    options.tallies = {.frequencies = {3000.0}};
    const Modulation found = trace_photons(two_layers, options).modulation.reflection[0];
    for (int i = 0; i < 2; ++i) {
      const Estimate& e = i == 0 ? found.amplitude : found.phase;
      mean[i] += e.value / runs;
      squares[i] += e.value * e.value;
      expected[i] += e.standard_error * e.standard_error / runs;
    }
  }
  for (int i = 0; i < 2; ++i) {
    const double variance = (squares[i] - runs * mean[i] * mean[i]) / (runs - 1);
    EXPECT_NEAR(std::sqrt(variance / expected[i]), 1.0, 0.2) << i;
  }
}

TEST(PhotonFlight, RefusesTimesAndFrequenciesOutOfRange) {
  MonteCarloOptions options{.photons = 10};
  options.tallies.time = {10, 0.0};
  EXPECT_THROW((void)trace_photons(two_layers, options), InvalidInput);
  options.tallies.time = {};
  options.tallies.frequencies = {-1.0};
  EXPECT_THROW((void)trace_photons(two_layers, options), InvalidInput);
}

}  // namespace
}  // namespace lamina
