// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Fits of what integrating spheres read.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lamina/skin/fit/measurement_fit.h"
#include "lamina/skin/fit/predicted/measurement_model.h"
#include "lamina/solve/integrating_sphere/lost_light.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "skin/fit/model_derivatives.h"

namespace lamina {
namespace {

/// Two unlike layers between slides.
const MeasuredMaterial sample{R"({ "lamina": "material", "version": 1, "length_unit": "mm",
  "bands": [600], "ior_below": 1, "layers": [
    { "sigma_a": 0, "sigma_s": 0, "g": 0, "ior": 1.52, "thickness": 1 },
    { "sigma_a": 0.02, "sigma_s_prime": 1, "g": 0.8, "ior": 1.35, "thickness": 1.5 },
    { "sigma_a": 0.3, "sigma_s_prime": 0.4, "g": 0.5, "ior": 1.4, "thickness": 0.2 },
    { "sigma_a": 0, "sigma_s": 0, "g": 0, "ior": 1.52, "thickness": 1 } ] })",
                              "sample"};

IntegratingSphere sphere(bool is_behind) {
  return {.diameter = 60.0,
          .sample_port = 12.0,
          .detector_port = 6.0,
          .entrance_port = is_behind ? 0.0 : 6.0,
          .wall_reflectance = 0.96,
          .standard_reflectance = is_behind ? 0.96 : 0.99,
          .has_baffle = is_behind};
}

FreeNumber positive_number(const std::string& path, double start) {
  return {{.name = path, .start = start, .low = 1e-4, .high = 100, .scale = FitScale::logarithmic},
          false};
}

Measurement measurement_of(double reflectance, double transmittance, double error) {
  Measurement measurement{.material = sample, .bands = BandSet({600.0})};
  MeasuredSeries series;
  for (const bool is_behind : {false, true})
    series.points.push_back(
        {.quantity = is_behind ? MeasuredQuantity::transmittance : MeasuredQuantity::reflectance,
         .value = is_behind ? transmittance : reflectance,
         .standard_deviation = error,
         .sphere = sphere(is_behind)});
  measurement.series = {series};
  measurement.free = {positive_number("layers[1].sigma_a", 0.1),
                      positive_number("layers[1].sigma_s_prime", 2.0)};
  return measurement;
}

// By what both layers are made of, and with the mirror reflection or without.
TEST(SphereFit, DerivativesAreThoseOfReadings) {
  for (const bool has_specular : {true, false}) {
    Measurement measurement = measurement_of(0.3, 0.4, 1e-3);
    measurement.series[0].has_specular = has_specular;
    measurement.free.push_back(positive_number("layers[2].sigma_a", 0.3));
    measurement.free.push_back(positive_number("layers[2].thickness", 0.2));
    const fit_detail::MeasurementModel model(measurement, {0}, {}, {});
    const std::vector<double> at = {0.03, 1.2, 0.3, 0.2};
    EXPECT_TRUE(model.is_exact(0, at));
    expect_derivatives_of_predictions(model, at, 1e-8);
  }
}

// Readings put together from totals and from photons of another seed come back to what they are
// of; without the correction for lost light they would be of a sample twice as dark.
TEST(SphereFit, ReadingsComeBackWithLostLight) {
  const LayerStack stack = layer_stack(sample.with({}), 0);
  const LayerStack turned(
      {stack.layers()[3], stack.layers()[2], stack.layers()[1], stack.layers()[0]});
  constexpr double beam = 3.0, port = 12.0, error = 0.003;
  const auto found = adding_doubling(stack);
  const LostLight lost = lost_light(stack, {}, beam, port, {.photons = 1'000'000, .seed = 99});
  const auto in_port = [&](const LayerStack& side) {
    const SlabTotals totals = adding_doubling(side, {.is_diffuse = true}).totals;
    return totals.specular_reflectance + totals.diffuse_reflectance -
           lost_light(side, {.is_diffuse = true}, port, port, {.photons = 200'000, .seed = 98})
               .reflected.value;
  };
  const double r =
      reflectance_reading(
          sphere(false),
          {.scattered = found.totals.specular_reflectance + found.totals.diffuse_reflectance -
                        found.unscattered_reflectance - lost.reflected.value,
           .straight = found.unscattered_reflectance},
          in_port(stack))
          .value;
  const double t =
      transmittance_reading(sphere(true),
                            {.scattered = found.totals.transmittance -
                                          found.unscattered_transmittance - lost.transmitted.value,
                             .straight = found.unscattered_transmittance},
                            in_port(turned))
          .value;
  Measurement measurement = measurement_of(r, t, error);
  measurement.series[0].beam_diameter = beam;
  const MeasurementFit fit = fit_measurement(measurement);
  EXPECT_TRUE(fit.has_converged);
  EXPECT_FALSE(fit.has_exact_derivatives[0]);
  const double error_a = fit.numbers[0].fitted.standard_deviation;
  const double error_s = fit.numbers[1].fitted.standard_deviation;
  EXPECT_LT(error_a, 0.2);  // of the logarithm
  EXPECT_LT(error_s, 0.05);
  EXPECT_NEAR(std::log(fit.values[0][0] / 0.02), 0.0, error_a);
  EXPECT_NEAR(std::log(fit.values[1][0]), 0.0, error_s);

  measurement.series[0].beam_diameter.reset();
  EXPECT_GT(fit_measurement(measurement).values[0][0], 0.04);
}

}  // namespace
}  // namespace lamina
