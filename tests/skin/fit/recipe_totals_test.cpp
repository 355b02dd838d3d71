// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/predicted/recipe_totals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "lamina/skin/fit/measurement_fit.h"
#include "lamina/skin/fit/skin/skin_fit.h"
#include "lamina/solve/reflectance/leaf_totals_table.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

constexpr Incidence beam{.theta = 8.0 * std::numbers::pi / 180.0};

/// Any leaf of the range.
LeafParameters any_leaf(Random& random) {
  const auto between = [&](double low, double high) {
    return low * std::pow(high / low, random.uniform());
  };
  return {.chlorophyll = between(0.1, 120.0),
          .carotenoids = between(0.1, 40.0),
          .anthocyanins = between(0.1, 40.0),
          .brown_pigments = between(0.01, 5.0),
          .water = between(1e-3, 0.1),
          .dry_matter = between(1e-4, 0.03),
          .structure = between(0.3, 10.0),
          .palisade_share = random.uniform()};
}

// Independent: the stack itself, on its own grid, refined until it is right to 1e-7.
TEST(LeafTotalsTable, GivesWhatAddingDoublingGives) {
  const std::vector<double> nm = {420.0, 480.0, 550.0, 680.0, 720.0, 970.0};
  LeafRange range = leaf_fit_range({});
  range.low.palisade_share = 0.0;
  range.high.palisade_share = 1.0;
  const LeafTotalsTable table(nm, beam, range);
  Random random = make_random(8, 0);
  for (int i = 0; i < 24; ++i) {
    const LeafParameters leaf = any_leaf(random);
    const std::size_t w = static_cast<std::size_t>(i) % nm.size();
    const SlabTotals direct =
        adding_doubling(leaf_layer_stack(leaf, nm[w]), beam, {.accuracy = 1e-6}).totals;
    const LeafTotalsTable::Totals totals = table.totals(leaf, w);
    EXPECT_NEAR(totals.reflectance, direct.diffuse_reflectance,
                1e-3 * std::max(direct.diffuse_reflectance, 3e-3));
    EXPECT_NEAR(totals.transmittance, direct.transmittance,
                1e-3 * std::max(direct.transmittance, 3e-3));
    EXPECT_NEAR(table.specular_reflectance(), direct.specular_reflectance, 1e-9);
  }
}

TEST(LeafTotalsTable, HasTheDerivativesOfItsDifferences) {
  const LeafTotalsTable table({550.0, 690.0}, beam, leaf_fit_range({}));
  const LeafParameters leaf;
  const std::array numbers = {&LeafParameters::chlorophyll, &LeafParameters::anthocyanins,
                              &LeafParameters::water, &LeafParameters::structure};
  for (std::size_t w = 0; w < 2; ++w) {
    std::array<LeafTotalsTable::Totals, 4> by;
    (void)table.totals(leaf, w, numbers, by);
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      LeafParameters more = leaf, less = leaf;
      const double step = 1e-3 * leaf.*numbers[n];
      more.*numbers[n] += step;
      less.*numbers[n] -= step;
      const auto above = table.totals(more, w), below = table.totals(less, w);
      const double r = (above.reflectance - below.reflectance) / (2.0 * step);
      const double t = (above.transmittance - below.transmittance) / (2.0 * step);
      EXPECT_NEAR(by[n].reflectance, r, 1e-5 * std::abs(r) + 1e-9);
      EXPECT_NEAR(by[n].transmittance, t, 1e-5 * std::abs(t) + 1e-9);
    }
  }
}

TEST(LeafTotalsTable, RefusesWhatItCannotHold) {
  LeafRange range = leaf_fit_range({});
  EXPECT_THROW(LeafTotalsTable({300.0}, beam, range), InvalidInput);
  range.high.structure = 0.1;
  EXPECT_THROW(LeafTotalsTable({500.0}, beam, range), InvalidInput);
}

constexpr const char* skin_text = R"({ "lamina": "material", "version": 1, "length_unit": "mm",
  "bands": [450, 500, 550, 580, 620, 680], "skin": { "melanin": 0.015 } })";
constexpr const char* leaf_text = R"({ "lamina": "material", "version": 1, "length_unit": "mm",
  "bands": [450, 500, 550, 580, 620, 680], "ior_below": 1, "leaf": { "chlorophyll": 35 } })";

FreeNumber free_number(const std::string& path, double start, double low, double high) {
  return {
      .parameter = {
          .name = path, .start = start, .low = low, .high = high, .scale = FitScale::logarithmic}};
}

/// Of a material as it is, known to an error.
Measurement measurement_of(const char* material, double error, bool has_transmittance) {
  Measurement measurement{.material = {material, "test"},
                          .bands = BandSet({450.0, 500.0, 550.0, 580.0, 620.0, 680.0})};
  const Material truth = measurement.material.with({});
  MeasuredSeries series{.incidence = beam};
  for (std::size_t band = 0; band < truth.bands.size(); ++band) {
    const SlabTotals found = adding_doubling(layer_stack(truth, band), beam).totals;
    series.points.push_back({.band = band,
                             .value = found.specular_reflectance + found.diffuse_reflectance,
                             .standard_deviation = error});
    if (has_transmittance)
      series.points.push_back({.band = band,
                               .quantity = MeasuredQuantity::transmittance,
                               .value = found.transmittance,
                               .standard_deviation = error});
  }
  measurement.series = {series};
  return measurement;
}

Measurement skin_measurement(double error = 0.003) {
  Measurement measurement = measurement_of(skin_text, error, false);
  measurement.free = {free_number("skin.melanin", 0.03, 1e-3, 0.5),
                      free_number("skin.hemoglobin_dermis", 0.004, 1e-4, 0.1),
                      free_number("skin.scattering_scale", 0.8, 0.3, 3.0)};
  return measurement;
}

bool has_table(const Measurement& measurement) {
  return fit_detail::has_recipe_totals(measurement, measurement.series[0]);
}

// The same fit by solutions, with tables that hold nothing.
void expect_table_like_solver(const Measurement& measurement) {
  ASSERT_TRUE(has_table(measurement));
  const MeasurementTables none;
  const MeasurementFit by_table = fit_measurement(measurement);
  const MeasurementFit by_solver = fit_measurement(measurement, {.tables = &none});
  EXPECT_TRUE(by_table.has_exact_derivatives[0]);
  for (std::size_t i = 0; i < by_table.numbers.size(); ++i) {
    const FittedParameter &a = by_table.numbers[i].fitted, &b = by_solver.numbers[i].fitted;
    EXPECT_NEAR(a.value, b.value, 0.05 * b.high_error) << by_table.numbers[i].name;
    EXPECT_NEAR(a.standard_deviation, b.standard_deviation, 0.01 * b.standard_deviation);
  }
  for (std::size_t p = 0; p < measurement.series[0].points.size(); ++p)
    EXPECT_NEAR(by_table.predicted[0][p], by_solver.predicted[0][p], 3e-4);
}

TEST(RecipeTotals, FitSkinAsSolutionsDo) { expect_table_like_solver(skin_measurement()); }

TEST(RecipeTotals, FitLeavesAsSolutionsDo) {
  Measurement measurement = measurement_of(leaf_text, 0.003, true);
  measurement.free = {free_number("leaf.chlorophyll", 20.0, 1.0, 120.0),
                      free_number("leaf.structure", 3.0, 0.3, 10.0)};
  expect_table_like_solver(measurement);
}

// A population in a measurement is the same fit as fit_skin with it.
TEST(RecipeTotals, KnowPopulationsAsFitSkinDoes) {
  Measurement measurement = skin_measurement();
  measurement.population = forearm_population();
  measurement.free.clear();
  const std::vector<SkinFitNumber> numbers = skin_fit_numbers({});
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    FreeNumber free{.parameter = numbers[i].parameter, .known = i};
    free.parameter.name = "skin." + free.parameter.name;
    free.parameter.prior = forearm_population().priors[i];
    free.parameter.start = free.parameter.prior->mean;
    if (i == 5) {
      free.parameter.name = "skin.saturation_dermis";
      free.further_paths = {"skin.saturation_epidermis"};
    }
    measurement.free.push_back(free);
  }
  SkinMeasurement spectrum;
  for (const MeasuredPoint& point : measurement.series[0].points) {
    spectrum.measured.push_back(point.value);
    spectrum.standard_deviation.push_back(point.standard_deviation);
  }
  const std::span<const double> nm = measurement.bands.wavelengths();
  const SkinReflectanceTable table({nm.begin(), nm.end()}, beam, skin_fit_range({}));
  const SkinFit by_library = fit_skin(table, spectrum, {}, numbers, &forearm_population());
  const MeasurementFit by_file = fit_measurement(measurement);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const FittedParameter &a = by_file.numbers[i].fitted, &b = by_library.fit.parameters[i];
    EXPECT_EQ(a.is_at_bound, b.is_at_bound) << numbers[i].parameter.name;
    if (b.is_at_bound) {  // it is unknown
      EXPECT_EQ(a.value, b.value) << numbers[i].parameter.name;
      continue;
    }
    EXPECT_NEAR(a.value, b.value, 1e-3 * b.high_error) << numbers[i].parameter.name;
    EXPECT_NEAR(a.standard_deviation, b.standard_deviation, 1e-3 * b.standard_deviation);
  }
  EXPECT_NEAR(by_file.chi_squared, by_library.fit.chi_squared, 1e-3);
}

TEST(RecipeTotals, AreForWhatTheirTablesHold) {
  const Measurement plain = skin_measurement();
  EXPECT_TRUE(has_table(plain));
  EXPECT_FALSE(has_table(skin_measurement(1e-5)));  // known better than the table
  Measurement other = plain;
  other.free[0].is_per_band = true;
  EXPECT_FALSE(has_table(other));
  other = plain;
  other.free[0].parameter.high = 1.0;
  EXPECT_FALSE(has_table(other));
  other = plain;
  other.free.push_back(free_number("skin.epidermis_thickness", 0.2, 0.05, 1.0));
  EXPECT_FALSE(has_table(other));
  other = plain;
  other.series[0].points[0].quantity = MeasuredQuantity::transmittance;
  EXPECT_FALSE(has_table(other));
  other = plain;
  other.material.text.replace(other.material.text.find("\"skin\""), 6,
                              "\"ior_above\": 1.33, \"skin\"");
  EXPECT_FALSE(has_table(other));
}

}  // namespace
}  // namespace lamina
