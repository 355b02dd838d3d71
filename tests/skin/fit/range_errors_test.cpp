// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/random.h"
#include "lamina/skin/fit/measurement_fit.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "skin/fit/normal_number.h"

namespace lamina {
namespace {

FreeNumber free_number(const std::string& path, double start, double low, double high,
                       FitScale scale = FitScale::logarithmic) {
  return {{.name = path, .start = start, .low = low, .high = high, .scale = scale}, false};
}

/// How often fits of a measurement with noise hold a truth within one and two errors.
struct Coverage {
  int draws = 0, at_range = 0;
  std::vector<int> within_one, within_two, known;  ///< [free number]
};

Coverage coverage(Measurement measurement, const std::vector<double>& truth, int draws) {
  const std::size_t n = truth.size();
  Coverage found{draws, 0, std::vector<int>(n), std::vector<int>(n), std::vector<int>(n)};
  const std::vector<MeasuredSeries> exact = measurement.series;
  MeasurementTables tables;
  tables.prepare(measurement, {});
  for (int draw = 0; draw < draws; ++draw) {
    Random random = make_random(31, static_cast<std::uint64_t>(draw));
    measurement.series = exact;
    for (MeasuredSeries& series : measurement.series)
      for (MeasuredPoint& point : series.points)
        point.value = std::max(0.0, point.value + point.standard_deviation * normal_number(random));
    const MeasurementFit fit = fit_measurement(measurement, {.tables = &tables});
    bool is_at_range = false;
    for (std::size_t i = 0; i < n; ++i) {
      const FittedParameter& number = fit.numbers[i].fitted;
      const FitParameter& parameter = measurement.free[i].parameter;
      const double off =
          std::abs(fit_coordinate(parameter, number.value) - fit_coordinate(parameter, truth[i]));
      found.within_one[i] += off <= number.standard_deviation;
      found.within_two[i] += off <= 2.0 * number.standard_deviation;
      found.known[i] += std::isfinite(number.standard_deviation);
      is_at_range = is_at_range || number.is_at_bound;
    }
    found.at_range += is_at_range;
  }
  return found;
}

/// Bands of three standard deviations of the counts below what Gaussian errors promise.
void expect_covered(const Coverage& found, std::size_t number) {
  const double n = found.draws;
  EXPECT_GE(found.within_one[number], n * 0.683 - 3.0 * std::sqrt(n * 0.683 * 0.317)) << number;
  EXPECT_GE(found.within_two[number], n * 0.954 - 3.0 * std::sqrt(n * 0.954 * 0.046)) << number;
}

// Waves on two layers, of which noise of 1 % takes the absorption above to the end of its range.
// No start finds less misfit, chi squared .135: it does not tell. Held there, the others had errors
// of a fiftieth, and the truth lay 12 and 37 of them off.
TEST(RangeErrors, WavesOnTwoLayersHoldTheTruth) {
  const MeasuredMaterial layers{
      R"({ "lamina": "material", "version": 1, "length_unit": "mm", "bands": [650], "layers": [
    { "sigma_a": 0.1, "sigma_s_prime": 1, "g": 0.8, "ior": 1.4, "thickness": 0.3 },
    { "sigma_a": 0.1, "sigma_s_prime": 1, "g": 0.8, "ior": 1.4, "thickness": "infinite" } ] })",
      "layers"};
  Measurement measurement{.material = layers, .bands = BandSet({650.0})};
  const std::vector<double> k = {0.0, 0.1, 0.3, 0.6, 1.0, 2.0, 3.0};
  const std::vector<double> read = {0.288254, 0.285023, 0.259635, 0.205625,
                                    0.150097, 0.08485,  0.058695};
  MeasuredSeries series{.kind = MeasurementKind::spatial_frequency};
  for (std::size_t i = 0; i < k.size(); ++i)
    series.points.push_back({.at = k[i], .value = read[i], .standard_deviation = 0.01 * read[i]});
  measurement.series = {series};
  measurement.free = {free_number("layers[0].sigma_a", 0.1, 1e-3, 10),
                      free_number("layers[0].sigma_s_prime", 1, 0.1, 20),
                      free_number("layers[1].sigma_a", 0.1, 1e-3, 10),
                      free_number("layers[1].sigma_s_prime", 1, 0.1, 20)};
  const MeasurementFit fit = fit_measurement(measurement);
  EXPECT_TRUE(fit.numbers[0].fitted.is_at_bound);
  EXPECT_TRUE(std::isinf(fit.numbers[0].fitted.high_error));
  EXPECT_LT(fit.chi_squared, 0.2);
  const std::vector<double> truth = {0.3, 2.0, 0.05, 1.2};
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const FittedParameter& number = fit.numbers[i].fitted;
    EXPECT_LT(std::abs(std::log(number.value / truth[i])), number.standard_deviation) << i;
    EXPECT_LT(number.standard_deviation, 3.0) << i;
  }
  EXPECT_EQ(std::ranges::count_if(fit.notes,
                                  [](const std::string& note) {
                                    return note.starts_with(
                                        "layers[0].sigma_a: unknown, since it ended at its range");
                                  }),
            1);
}

// A slab through which no light comes unscattered tells nothing of g, and all of absorption.
TEST(RangeErrors, AbsorptionIsKnownWithoutTheMeanCosine) {
  const MeasuredMaterial slab{
      R"({ "lamina": "material", "version": 1, "length_unit": "mm", "bands": [650], "ior_below": 1,
    "layers": [{ "sigma_a": 0.05, "sigma_s_prime": 1, "g": 0.9, "ior": 1.4, "thickness": 2 }] })",
      "slab"};
  Measurement measurement{.material = slab, .bands = BandSet({650.0})};
  const auto exact = adding_doubling(layer_stack(slab.with({}), 0), {}, {.accuracy = 1e-7});
  MeasuredSeries series{.kind = MeasurementKind::totals};
  const auto add = [&](MeasuredQuantity quantity, double value, double sd) {
    series.points.push_back({.quantity = quantity, .value = value, .standard_deviation = sd});
  };
  add(MeasuredQuantity::reflectance,
      exact.totals.specular_reflectance + exact.totals.diffuse_reflectance, 0.003);
  add(MeasuredQuantity::transmittance, exact.totals.transmittance, 0.003);
  add(MeasuredQuantity::unscattered_transmittance, 0.0, 1e-4);
  measurement.series = {series};
  measurement.free = {free_number("layers[0].sigma_a", 0.1, 1e-5, 100),
                      free_number("layers[0].sigma_s_prime", 2, 1e-3, 100),
                      free_number("layers[0].g", 0.8, -0.9, 0.99, FitScale::linear)};
  const MeasurementFit fit = fit_measurement(measurement);
  EXPECT_TRUE(std::isinf(fit.numbers[2].fitted.standard_deviation));
  EXPECT_LT(fit.numbers[0].fitted.standard_deviation, 0.04);
  EXPECT_LT(fit.numbers[1].fitted.standard_deviation, 0.05);
  const Coverage found = coverage(measurement, {0.05, 1.0, 0.9}, 40);
  for (const std::size_t number : {0, 1}) {
    EXPECT_EQ(found.known[number], 40);
    expect_covered(found, number);
  }
  EXPECT_LT(found.known[2], 25);
}

// A slope of one standard deviation that may not be negative: where it ends at 0, the offset takes
// its part. With the error of a measurement that knew the slope, 28 % of these held the truth.
TEST(RangeErrors, OffsetsOfLinesHoldTheTruthWhereTheSlopeEndsAtItsRange) {
  const FitModel line{.predict = [](std::span<const double> p) {
    std::vector<double> y;
    for (int x = 0; x < 10; ++x) y.push_back(p[0] + p[1] * x);
    return y;
  }};
  const std::vector<double> truth = {2.0, 0.11};
  int at_range = 0, within = 0, within_at_range = 0;
  constexpr int draws = 2000;
  for (int draw = 0; draw < draws; ++draw) {
    Random random = make_random(5, static_cast<std::uint64_t>(draw));
    FitData data{.measured = line.predict(truth), .standard_deviation = std::vector(10, 1.0)};
    for (double& value : data.measured) value += normal_number(random);
    const FitResult fit = fit_parameters(
        {{.name = "offset", .start = 1.0}, {.name = "slope", .start = 0.1, .low = 0.0}}, data,
        line);
    const FittedParameter& offset = fit.parameters[0];
    const bool is_within = std::abs(offset.value - truth[0]) <= offset.standard_deviation;
    within += is_within;
    if (!fit.parameters[1].is_at_bound) continue;
    ++at_range;
    within_at_range += is_within;
  }
  EXPECT_GT(at_range, 240);  // 16 %
  EXPECT_GE(within, 0.65 * draws);
  EXPECT_LE(within, 0.75 * draws);
  EXPECT_GE(within_at_range, 0.5 * at_range);
}

}  // namespace
}  // namespace lamina
