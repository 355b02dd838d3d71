// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/measurement_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "lamina/skin/fit/predicted/measurement_model.h"
#include "lamina/skin/fit/predicted/series_prediction.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "lamina/solve/scattering/transport_profile/spatial_frequency_response.h"
#include "skin/fit/model_derivatives.h"

namespace lamina {
namespace {

/// Two layers by laws, over an open lower side.
const MeasuredMaterial layers{R"({ "lamina": "material", "version": 1, "length_unit": "mm",
  "bands": [500, 560, 620], "ior_below": 1, "layers": [
    { "sigma_a": { "a": 0.4, "b": 3 }, "sigma_s_prime": { "a": 3, "b": 1 }, "g": 0.7,
      "ior": 1.4, "thickness": 0.2 },
    { "sigma_a": { "a": 0.1, "b": 1 }, "sigma_s_prime": { "a": 2, "b": 0.8 }, "g": 0.8,
      "ior": 1.37, "thickness": 1.5 } ] })",
                              "layers"};

FreeNumber free_number(const std::string& path, double start, double low, double high,
                       FitScale scale = FitScale::logarithmic, bool is_per_band = false) {
  return {{.name = path, .start = start, .low = low, .high = high, .scale = scale}, is_per_band};
}

/// Totals of a measurement's material as they are, known to an error.
MeasuredSeries totals_of(const Material& truth, double error, bool has_unscattered) {
  MeasuredSeries series;
  for (std::size_t band = 0; band < truth.bands.size(); ++band) {
    const auto found = adding_doubling(layer_stack(truth, band), {}, {.accuracy = 1e-9});
    const auto add = [&](MeasuredQuantity quantity, double value, double sd) {
      series.points.push_back(
          {.band = band, .quantity = quantity, .value = value, .standard_deviation = sd});
    };
    add(MeasuredQuantity::reflectance,
        found.totals.specular_reflectance + found.totals.diffuse_reflectance, error);
    add(MeasuredQuantity::transmittance, found.totals.transmittance, error);
    if (has_unscattered)
      add(MeasuredQuantity::unscattered_transmittance, found.unscattered_transmittance,
          error * found.unscattered_transmittance);
  }
  return series;
}

// Each band for itself: its three totals tell its three coefficients, to 1e-4.
TEST(MeasurementFit, BandsComeBack) {
  Measurement measurement{.material = layers, .bands = BandSet({500.0, 560.0, 620.0})};
  const Material truth = layers.with({});
  measurement.series = {totals_of(truth, 1e-6, true)};
  measurement.free = {
      free_number("layers[1].sigma_a", 0.3, 1e-4, 10, FitScale::logarithmic, true),
      free_number("layers[1].sigma_s_prime", 1.0, 1e-2, 100, FitScale::logarithmic, true),
      free_number("layers[1].g", 0.5, -0.9, 0.99, FitScale::linear, true)};
  const MeasurementFit fit = fit_measurement(measurement);
  EXPECT_TRUE(fit.has_converged);
  EXPECT_EQ(fit.groups.size(), 3U);
  EXPECT_TRUE(fit.has_exact_derivatives[0]);
  EXPECT_EQ(fit.numbers[5].name, "layers[1].g at 560 nm");
  for (std::size_t band = 0; band < 3; ++band) {
    const Medium is = layer_stack(truth, band).layers()[1].medium;
    EXPECT_NEAR(fit.values[0][band] / is.sigma_a, 1.0, 1e-4);
    EXPECT_NEAR(fit.values[1][band] / sigma_s_prime(is), 1.0, 1e-4);
    EXPECT_NEAR(fit.values[2][band], is.g, 1e-4);
  }
}

// Thin slabs that scatter sharply forward take many directions: quick solutions alone would miss.
TEST(MeasurementFit, IsAsRightAsAccurateSolutions) {
  const MeasuredMaterial thin{
      R"({ "lamina": "material", "version": 1, "length_unit": "mm", "bands": [600], "ior_below": 1,
    "layers": [{ "sigma_a": 0.3, "sigma_s_prime": 0.4, "g": 0.95, "ior": 1.33, "thickness": 0.1 }] })",
      "thin"};
  Measurement measurement{.material = thin, .bands = BandSet({600.0})};
  measurement.series = {totals_of(thin.with({}), 1e-7, true)};
  measurement.free = {free_number("layers[0].sigma_a", 0.1, 1e-4, 10),
                      free_number("layers[0].sigma_s_prime", 1.0, 1e-2, 100),
                      free_number("layers[0].g", 0.9, -0.9, 0.99, FitScale::linear)};
  const MeasurementFit fit = fit_measurement(measurement);
  EXPECT_NEAR(fit.values[0][0], 0.3, 3e-5);
  EXPECT_NEAR(fit.values[1][0], 0.4, 4e-5);
  EXPECT_NEAR(fit.values[2][0], 0.95, 1e-4);
}

// Numbers of laws that all bands share, and one of each band.
TEST(MeasurementFit, SharedNumbersComeBack) {
  Measurement measurement{.material = layers, .bands = BandSet({500.0, 560.0, 620.0})};
  const std::vector<std::string> settings = {"layers[0].sigma_a=[0.5,0.2,0.1]"};
  measurement.series = {totals_of(layers.with(settings), 1e-6, false)};
  measurement.free = {free_number("layers[0].sigma_a", 0.3, 1e-3, 10, FitScale::logarithmic, true),
                      free_number("layers[1].sigma_s_prime.a", 1.0, 0.1, 10),
                      free_number("layers[1].sigma_s_prime.b", 0.5, 0.0, 3, FitScale::linear)};
  const MeasurementFit fit = fit_measurement(measurement);
  EXPECT_TRUE(fit.has_converged);
  EXPECT_EQ(fit.groups.size(), 1U);
  EXPECT_EQ(fit.degrees_of_freedom, 1);
  EXPECT_LT(fit.chi_squared, 0.1);
  const std::vector<double> truth = {0.5, 0.2, 0.1};
  for (std::size_t band = 0; band < 3; ++band)
    EXPECT_NEAR(fit.values[0][band] / truth[band], 1.0, 2e-4);
  EXPECT_NEAR(fit.values[1][0], 2.0, 2e-4);
  EXPECT_NEAR(fit.values[2][0], 0.8, 2e-4);
}

// Derivatives of layers times those by the free numbers are those of the whole: absorption,
// scattering, g and thickness exactly, an index and a profile by differences.
TEST(MeasurementFit, DerivativesAreThoseOfThePrediction) {
  Measurement measurement{.material = layers, .bands = BandSet({560.0})};
  measurement.series = {totals_of(layers.with(std::vector<std::string>{"bands=[560]"}), 1e-3, true),
                        {.kind = MeasurementKind::spatial_frequency},
                        {.kind = MeasurementKind::radial_profile, .detector_width = 0.4}};
  for (const double k : {0.0, 0.3})
    measurement.series[1].points.push_back({.at = k, .value = 0.2, .standard_deviation = 0.01});
  for (const double r : {0.5, 2.0})
    measurement.series[2].points.push_back({.at = r, .value = 0.02, .standard_deviation = 0.001});
  measurement.free = {free_number("layers[0].sigma_a.a", 0.3, 1e-3, 10),
                      free_number("layers[1].sigma_s_prime.a", 1.5, 0.1, 10),
                      free_number("layers[1].g", 0.6, -0.9, 0.95, FitScale::linear),
                      free_number("layers[0].thickness", 0.3, 0.01, 1),
                      free_number("layers[1].ior", 1.38, 1.3, 1.5, FitScale::linear)};
  const fit_detail::MeasurementModel model(measurement, {0}, {}, {});
  const std::vector<double> at = {0.3, 1.5, 0.6, 0.3, 1.38};
  EXPECT_EQ(model.derivatives(at).rows, 7U);
  EXPECT_FALSE(model.is_exact(0, at));  // for its index
  expect_derivatives_of_predictions(model, at, 1e-7);
}

// What uniform light cannot tell is said, in the words of the file.
TEST(MeasurementFit, SaysWhatIsNotTold) {
  Measurement measurement{.material = layers, .bands = BandSet({560.0})};
  const std::vector<std::string> settings = {"bands=[560]", "layers[0].thickness=1e-6"};
  measurement.material.text.replace(measurement.material.text.find("\"thickness\": 0.2"), 16,
                                    "\"thickness\": 1e-6");
  measurement.series = {totals_of(layers.with(settings), 1e-3, false)};
  measurement.free = {free_number("layers[1].sigma_a.a", 0.2, 1e-3, 10),
                      free_number("layers[1].sigma_s_prime.a", 1.5, 1e-3, 100),
                      free_number("layers[1].thickness", 1.2, 1e-3, 100)};
  measurement.free[2].parameter.prior = FitPrior{1.5, 0.1};
  const MeasurementFit fit = fit_measurement(measurement);
  EXPECT_NEAR(fit.values[2][0], 1.5, 1e-3);
  EXPECT_EQ(
      std::ranges::count(fit.notes, "layers[1].thickness: from the prior, the data add little"), 1);
}

// Waves of light on a half-space, as radiative transfer has them at many directions.
TEST(MeasurementFit, WavesTellAbsorptionAndScattering) {
  const MeasuredMaterial half_space{
      R"({ "lamina": "material", "version": 1, "length_unit": "mm", "bands": [650], "layers": [
    { "sigma_a": 0.02, "sigma_s_prime": 1.1, "g": 0.8, "ior": 1.4, "thickness": "infinite" } ] })",
      "half-space"};
  Measurement measurement{.material = half_space, .bands = BandSet({650.0})};
  const std::vector<double> k = {0.0, 0.1, 0.3};
  const auto truth =
      spatial_frequency_response(layer_stacks(half_space.with({})), k, {.accuracy = 1e-3});
  MeasuredSeries series{.kind = MeasurementKind::spatial_frequency};
  for (std::size_t i = 0; i < k.size(); ++i)
    series.points.push_back({.at = k[i],
                             .value = truth.reflectance[i],
                             .standard_deviation = 0.005 * truth.reflectance[i]});
  measurement.series = {series};
  measurement.free = {free_number("layers[0].sigma_a", 0.1, 1e-4, 10),
                      free_number("layers[0].sigma_s_prime", 2.0, 1e-2, 100)};
  const MeasurementFit fit = fit_measurement(measurement);
  EXPECT_NEAR(fit.values[0][0], 0.02, 2e-4);
  EXPECT_NEAR(fit.values[1][0], 1.1, 5e-3);
}

// Uniform light leaves an epidermis as thick as it was thought to be; waves see it, and both is
// said.
TEST(MeasurementFit, WavesTellHowThickTheEpidermisIs) {
  const MeasuredMaterial skin{R"({ "lamina": "material", "version": 1, "length_unit": "mm",
    "bands": [526, 591, 731], "skin": { "melanin": 0.03, "hemoglobin_dermis": 0.01,
      "scattering_scale": 0.6, "epidermis_thickness": 0.1 } })",
                              "skin"};
  Measurement measurement{.material = skin, .bands = BandSet({526.0, 591.0, 731.0})};
  const std::vector<double> k = {0.0, 0.05, 0.2};
  const auto truth = spatial_frequency_response(layer_stacks(skin.with({})), k, {.accuracy = 1e-3});
  const auto free = [](const std::string& path, double start, double sd) {
    FreeNumber number = free_number(path, start, 0.01 * start, 10.0 * start);
    number.parameter.prior = FitPrior{start, sd};
    return number;
  };
  measurement.free = {free("skin.epidermis_thickness", 0.12, 0.3), free("skin.melanin", 0.02, 1.0),
                      free("skin.hemoglobin_dermis", 0.02, 1.0),
                      free("skin.scattering_scale", 0.8, 1.0),
                      free("skin.baseline_scale", 0.1, 1.0)};
  const auto fit_with = [&](std::size_t frequencies) {
    MeasuredSeries series{.kind = MeasurementKind::spatial_frequency};
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t i = 0; i < frequencies; ++i)
        series.points.push_back({.band = b,
                                 .at = k[i],
                                 .value = truth.reflectance[3 * i + b],
                                 .standard_deviation = 0.0025 * truth.reflectance[3 * i + b]});
    measurement.series = {series};
    return fit_measurement(measurement);
  };
  const std::string note = "skin.epidermis_thickness: from the prior, the data add little";
  const MeasurementFit uniform = fit_with(1), waves = fit_with(3);
  EXPECT_EQ(std::ranges::count(uniform.notes, note), 1)
      << uniform.numbers[0].fitted.prior_share << " of the prior";
  EXPECT_EQ(std::ranges::count(waves.notes, note), 0);
  EXPECT_LT(waves.numbers[0].fitted.prior_share, 0.65);
  EXPECT_NEAR(waves.values[0][0], 0.1, waves.numbers[0].fitted.high_error);
  EXPECT_NEAR(waves.values[3][0], 0.6, 0.03);
}

// Rings of photons around a beam: found by diffusion, corrected by radiative transfer.
TEST(MeasurementFit, RingsOfPhotonsComeBackWithinTheirErrors) {
  const MeasuredMaterial half_space{
      R"({ "lamina": "material", "version": 1, "length_unit": "mm", "bands": [650], "layers": [
    { "sigma_a": 0.05, "sigma_s_prime": 1, "g": 0.7, "ior": 1.4, "thickness": "infinite" } ] })",
      "half-space"};
  Measurement measurement{.material = half_space, .bands = BandSet({650.0})};
  MonteCarloOptions options{.photons = 400'000, .seed = 5};
  options.tallies.detectors = {0.5, 1.0, 2.0, 4.0};
  options.tallies.detector_width = 0.4;
  const MonteCarloResult photons = trace_photons(layer_stack(half_space.with({}), 0), options);
  MeasuredSeries series{.kind = MeasurementKind::radial_profile, .detector_width = 0.4};
  for (std::size_t i = 0; i < options.tallies.detectors.size(); ++i) {
    const Estimate ring = photons.detectors[i];
    series.points.push_back({.at = options.tallies.detectors[i],
                             .value = ring.value,
                             .standard_deviation = ring.standard_error});
  }
  measurement.series = {series};
  measurement.free = {free_number("layers[0].sigma_a", 0.2, 1e-4, 10),
                      free_number("layers[0].sigma_s_prime", 2.0, 1e-2, 100)};
  const MeasurementFit fit = fit_measurement(measurement);
  EXPECT_NEAR(fit.values[0][0], 0.05, 3.0 * fit.numbers[0].fitted.high_error);
  EXPECT_NEAR(fit.values[1][0], 1.0, 3.0 * fit.numbers[1].fitted.high_error);
  EXPECT_LT(fit.numbers[0].fitted.high_error, 0.003);
  EXPECT_LT(fit.numbers[1].fitted.high_error, 0.05);
  EXPECT_LT(fit.chi_squared, 10.0);

  // Errors are those of accurate solutions, not of diffusion: from their differences at the end.
  std::vector<std::vector<double>> change;
  for (std::size_t u = 0; u < 2; ++u) {
    const auto at = [&](double step) {
      std::vector<std::vector<double>> values = fit.values;
      values[u][0] *= std::exp(step);
      return fit_detail::predict_accurately(layer_stack(material_with(measurement, values), 0),
                                            series, series.points);
    };
    const auto low = at(-0.1), high = at(0.1);
    std::vector<double> by;
    for (std::size_t i = 0; i < low.size(); ++i)
      by.push_back((high[i] - low[i]) / 0.2 / series.points[i].standard_deviation);
    change.push_back(by);
  }
  DenseMatrix curvature(2, 2);
  for (std::size_t u = 0; u < 2; ++u)
    for (std::size_t v = 0; v < 2; ++v)
      curvature(u, v) =
          std::inner_product(change[u].begin(), change[u].end(), change[v].begin(), 0.0);
  const double determinant = curvature(0, 0) * curvature(1, 1) - curvature(0, 1) * curvature(1, 0);
  for (std::size_t u = 0; u < 2; ++u)
    EXPECT_NEAR(
        fit.numbers[u].fitted.standard_deviation / std::sqrt(curvature(1 - u, 1 - u) / determinant),
        1.0, 0.03);
}

}  // namespace
}  // namespace lamina
