// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace lamina {
namespace {

struct NamedEstimate {
  std::string name;
  Estimate estimate;
};

std::vector<NamedEstimate> all_tallies(const MonteCarloResult& result) {
  std::vector<NamedEstimate> all;
  const auto add = [&](const std::string& name, const std::vector<Estimate>& estimates) {
    for (std::size_t i = 0; i < estimates.size(); ++i)
      all.push_back({name + " " + std::to_string(i), estimates[i]});
  };
  const auto add_both = [&](const std::string& name, const TwoSided& both) {
    add(name + " of R", both.reflection);
    add(name + " of T", both.transmission);
  };
  add("totals",
      {result.diffuse_reflectance, result.transmittance, result.mean_path_reflected,
       result.mean_path_transmitted, result.mean_time_reflected, result.mean_time_transmitted});
  add("absorptance", result.absorptance);
  add_both("mean layer path", result.mean_layer_path);
  add_both("radial", result.radial);
  add_both("angular", result.angular);
  add_both("path length", result.path_length);
  add_both("time", result.time);
  add("detectors", result.detectors);
  add("absorption", result.absorption);
  add("fluence", result.fluence);
  for (const auto* side : {&result.modulation.reflection, &result.modulation.transmission})
    for (const Modulation& one : *side) add("modulation", {one.amplitude, one.phase});
  return all;
}

/// Compares stated errors with the spread of runs of other seeds. The sum of their squares over
/// those stated is that of chi squared; the bands are 4.5 of its standard deviations.
void expect_errors_as_stated(const LayerStack& stack, std::uint64_t photons) {
  constexpr int seeds = 64;
  std::vector<std::vector<NamedEstimate>> runs;
  for (int seed = 0; seed < seeds; ++seed) {
    MonteCarloOptions options{.photons = photons, .seed = 100 + static_cast<std::uint64_t>(seed)};
    options.tallies.r = {4, 0.5};
    options.tallies.depth = {6, 0.5};
    options.tallies.fluence = true;
    options.tallies.angles = 3;
    options.tallies.mean_path_length = true;
    options.tallies.path_length = {5, 3.0};
    options.tallies.time = {5, 15.0};
    options.tallies.frequencies = {100.0};
    options.tallies.detectors = {1.0, 2.0};
    options.tallies.detector_width = 0.5;
    runs.push_back(all_tallies(trace_photons(stack, options)));
  }
  const double dof = seeds - 1.0, band = 4.5 * std::sqrt(2.0 / dof);
  for (std::size_t i = 0; i < runs[0].size(); ++i) {
    double mean = 0.0, spread = 0.0, stated = 0.0;
    for (const auto& run : runs) mean += run[i].estimate.value / seeds;
    for (const auto& run : runs) {
      spread += std::pow(run[i].estimate.value - mean, 2.0) / dof;
      stated += std::pow(run[i].estimate.standard_error, 2.0) / seeds;
    }
    const std::string what = runs[0][i].name + ": " + std::to_string(mean) + ", spread " +
                             std::to_string(std::sqrt(spread)) + ", stated " +
                             std::to_string(std::sqrt(stated));
    EXPECT_LE(spread, (1.0 + band) * stated) << what;
    if (std::sqrt(spread) < 0.15 * std::abs(mean)) {  // beyond, what was never seen adds to them
      EXPECT_GE((1.0 + band) * spread, stated) << what;
    }
  }
}

// Shallow and deep cells of two layers. A last batch of 32 photons, which counted as a whole one,
// made errors of volumes 2.8 times too large; one more photon off by a whole phase, phases 1.6.
TEST(PhotonErrors, AreTheSpreadOfRunsOfOtherSeeds) {
  expect_errors_as_stated(
      LayerStack(
          {{.medium = {.sigma_a = 0.1, .sigma_s = 5.0, .g = 0.8, .ior = 1.4}, .thickness = 1.0},
           {.medium = {.sigma_a = 0.3, .sigma_s = 8.0, .g = 0.8, .ior = 1.4}, .thickness = 2.0}}),
      20'000);
}

// Paths through a thin slab hardly differ: one more photon off by a whole path made their errors
// larger.
TEST(PhotonErrors, OfPathsThroughThinSlabsAreThatSmall) {
  expect_errors_as_stated(
      LayerStack({{.medium = {.sigma_a = 0.05, .sigma_s = 1.0, .g = 0.9}, .thickness = 0.2}}), 400);
}

}  // namespace
}  // namespace lamina
