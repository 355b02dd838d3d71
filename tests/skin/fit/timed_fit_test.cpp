// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Fits of light over time, and of modulated light.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/skin/fit/measurement_fit.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace lamina {
namespace {

const MeasuredMaterial tissue{
    R"({ "lamina": "material", "version": 1, "length_unit": "mm", "bands": [750], "layers": [
  { "sigma_a": 0.01, "sigma_s_prime": 1, "g": 0.8, "ior": 1.4, "thickness": "infinite" } ] })",
    "tissue"};

FreeNumber logarithmic(const std::string& path, double start, double low, double high) {
  return {{.name = path, .start = start, .low = low, .high = high, .scale = FitScale::logarithmic}};
}

MonteCarloResult photons_of(const MeasuredMaterial& material, const std::vector<double>& radii,
                            const std::vector<double>& frequencies, std::uint64_t photons) {
  MonteCarloOptions options{.photons = photons, .seed = 77};
  options.tallies = {
      .time = {60, 25.0}, .frequencies = frequencies, .detectors = radii, .detector_width = 2.0};
  return trace_photons(layer_stack(material.with({}), 0), options);
}

/// Photons of rings over time, with their own noise, times a factor.
MeasuredSeries curve_of(const MonteCarloResult& photons, const std::vector<double>& radii,
                        double factor) {
  MeasuredSeries series{
      .kind = MeasurementKind::time_resolved, .detector_width = 2.0, .is_relative = factor != 1.0};
  series.instrument = {{-9.6825, 5.0 / 18.0}, {0.0, 8.0 / 18.0}, {9.6825, 5.0 / 18.0}};
  for (std::size_t d = 0; d < radii.size(); ++d)
    for (std::size_t bin = radii[d] < 5.0 ? 1 : 3; bin < 20; ++bin) {
      const Estimate& e = photons.detector_time[d * 60 + bin];
      series.points.push_back({.at = 25.0 * (static_cast<double>(bin) + 0.5),
                               .r = radii[d],
                               .value = factor * e.value,
                               .standard_deviation = factor * e.standard_error});
    }
  return series;
}

/// The truth within so many errors, that are of at most these parts of it.
void expect_truth(const MeasurementFit& fit, const std::vector<double>& truth,
                  const std::vector<double>& largest_errors) {
  EXPECT_TRUE(fit.has_converged);
  for (std::size_t u = 0; u < truth.size(); ++u) {
    const FittedParameter& found = fit.numbers[u].fitted;
    EXPECT_NEAR(found.value, truth[u], 3.0 * found.high_error) << fit.numbers[u].name;
    EXPECT_LT(found.high_error, largest_errors[u] * truth[u]) << fit.numbers[u].name;
  }
  EXPECT_LT(fit.chi_squared,
            static_cast<double>(fit.degrees_of_freedom) +
                4.0 * std::sqrt(2.0 * static_cast<double>(fit.degrees_of_freedom)));
  EXPECT_TRUE(std::ranges::any_of(fit.notes, [](const std::string& note) {
    return note.find("photons in them, that correct diffusion") != std::string::npos;
  }));
}

/// Fits the two coefficients of tissue from rather wrong ones.
MeasurementFit fit_tissue(const MeasuredSeries& series) {
  Measurement measurement{.material = tissue, .bands = BandSet({750.0})};
  measurement.series = {series};
  measurement.series[0].photons = 2e5;
  measurement.free = {logarithmic("layers[0].sigma_a", 0.03, 1e-4, 1.0),
                      logarithmic("layers[0].sigma_s_prime", 2.0, 0.1, 10.0)};
  return fit_measurement(measurement);
}

// Curves at two distances from the beam, one in 1/mm²/ps, the other in counts of a detector: of
// these a factor is free.
TEST(TimedFit, PhotonsOverTimeComeBack) {
  const auto photons = photons_of(tissue, {3.0, 8.0}, {}, 200'000);
  const MeasurementFit absolute = fit_tissue(curve_of(photons, {3.0, 8.0}, 1.0));
  expect_truth(absolute, {0.01, 1.0}, {0.04, 0.03});
  const MeasurementFit relative = fit_tissue(curve_of(photons, {3.0, 8.0}, 5e4));
  expect_truth(relative, {0.01, 1.0}, {0.08, 0.04});
  EXPECT_EQ(relative.degrees_of_freedom, absolute.degrees_of_freedom - 2);
}

// Absorption of two layers of other indices, by the light that comes back late from the lower one.
TEST(TimedFit, LayersOverTimeComeBack) {
  const MeasuredMaterial layers{
      R"({ "lamina": "material", "version": 1, "length_unit": "mm", "bands": [750], "layers": [
    { "sigma_a": 0.02, "sigma_s_prime": 1.2, "g": 0.8, "ior": 1.4, "thickness": 4 },
    { "sigma_a": 0.006, "sigma_s_prime": 0.8, "g": 0.8, "ior": 1.36, "thickness": "infinite" } ] })",
      "layers"};
  const auto photons = photons_of(layers, {5.0, 10.0}, {}, 200'000);
  Measurement measurement{.material = layers, .bands = BandSet({750.0})};
  measurement.series = {curve_of(photons, {5.0, 10.0}, 1.0)};
  measurement.series[0].photons = 2e5;
  measurement.free = {logarithmic("layers[0].sigma_a", 0.01, 1e-4, 1.0),
                      logarithmic("layers[1].sigma_a", 0.01, 1e-4, 1.0)};
  expect_truth(fit_measurement(measurement), {0.02, 0.006}, {0.05, 0.25});
}

// Amplitude and phase at two distances; phases count modulo 360 degrees, and in place of amplitudes
// some times a common factor are as good.
TEST(TimedFit, ModulatedLightComesBack) {
  const std::vector<double> radii = {5.0, 10.0}, frequencies = {100.0, 400.0};
  const auto photons = photons_of(tissue, radii, frequencies, 200'000);
  constexpr double degrees = 180.0 / std::numbers::pi;
  for (const double factor : {1.0, 1e6}) {
    MeasuredSeries series{.kind = MeasurementKind::frequency_modulated,
                          .detector_width = 2.0,
                          .is_relative = factor != 1.0};
    for (std::size_t d = 0; d < radii.size(); ++d)
      for (std::size_t f = 0; f < frequencies.size(); ++f) {
        const Modulation& m = photons.detector_modulation[d * frequencies.size() + f];
        series.points.push_back({.quantity = MeasuredQuantity::amplitude,
                                 .at = frequencies[f],
                                 .r = radii[d],
                                 .value = factor * m.amplitude.value,
                                 .standard_deviation = factor * m.amplitude.standard_error});
        series.points.push_back({.quantity = MeasuredQuantity::phase,
                                 .at = frequencies[f],
                                 .r = radii[d],
                                 .value = m.phase.value * degrees + 360.0,
                                 .standard_deviation = m.phase.standard_error * degrees});
      }
    expect_truth(fit_tissue(series), {0.01, 1.0}, {0.05, 0.03});
  }
}

// Light in lightless glass does not diffuse: refused, and by name.
TEST(TimedFit, RefusesLayersThatDoNotScatter) {
  const MeasuredMaterial glass{
      R"({ "lamina": "material", "version": 1, "length_unit": "mm", "bands": [750], "layers": [
    { "sigma_a": 0, "sigma_s": 0, "g": 0, "ior": 1.5, "thickness": 1 },
    { "sigma_a": 0.006, "sigma_s_prime": 0.8, "g": 0.8, "ior": 1.36, "thickness": "infinite" } ] })",
      "glass"};
  Measurement measurement{.material = glass, .bands = BandSet({750.0})};
  measurement.series = {{.kind = MeasurementKind::time_resolved}};
  for (const double t : {200.0, 300.0})
    measurement.series[0].points.push_back(
        {.at = t, .r = 5.0, .value = 1e-6, .standard_deviation = 1e-8});
  measurement.free = {logarithmic("layers[1].sigma_a", 0.01, 1e-4, 1.0)};
  try {
    (void)fit_measurement(measurement);
    ADD_FAILURE();
  } catch (const InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()),
              "layer 0: diffusion requires sigma_s > 0 [1/mm], but is 0");
  }
}

}  // namespace
}  // namespace lamina
