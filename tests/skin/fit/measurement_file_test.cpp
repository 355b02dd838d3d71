// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "base/io/bad_files.h"
#include "lamina/base/core/error.h"
#include "lamina/skin/fit/measured/measurement.h"
#include "lamina/skin/fit/predicted/measurement_model.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

const fs::path inputs = fs::path(LAMINA_SOURCE_DIR) / "tests/inputs/measurement";

std::string refusal(const fs::path& file) {
  try {
    (void)load_measurement(file);
  } catch (const Error& error) {
    return error.what();
  }
  return "(taken)";
}

TEST(MeasurementFile, EveryBadFileIsRefusedInOneLineThatNamesTheFault) {
  EXPECT_GT(expect_refusals(inputs / "bad", refusal), 35U);
}

// What a spectrometer writes: of itself first, falling wavelengths, percent in the names, decimal
// commas; and names of one's own.
TEST(MeasurementFile, TakesFilesOfSpectrometers) {
  const Measurement instrument = load_measurement(inputs / "good/instrument.json");
  ASSERT_EQ(instrument.bands.size(), 3U);
  EXPECT_EQ(instrument.bands.wavelengths()[0], 550.0);
  ASSERT_EQ(instrument.series[0].points.size(), 6U);
  EXPECT_EQ(instrument.series[0].points[0].band, 0U);
  EXPECT_NEAR(instrument.series[0].points[0].value, 0.28, 1e-15);
  EXPECT_NEAR(instrument.series[0].points[5].value, 0.42, 1e-15);
  const Measurement named = load_measurement(inputs / "good/named.json");
  ASSERT_EQ(named.series[0].points.size(), 4U);
  EXPECT_EQ(named.series[0].points[3].value, 0.40);
}

// fx is one over the period, k is 2 pi times that.
TEST(MeasurementFile, TakesFrequenciesOfPeriods) {
  const Measurement periods = load_measurement(inputs / "good/periods.json");
  EXPECT_EQ(periods.series[0].points[0].at, 0.0);
  EXPECT_NEAR(periods.series[0].points[1].at, 0.314159265358979, 1e-14);
}

// M_R = r_std R / R_std and M_T = T / T_empty are the readings of reflectance_reading and
// transmittance_reading; the order of numbers is that of iad's manual.
TEST(MeasurementFile, TakesFilesOfIad) {
  const Measurement read = load_measurement(inputs / "good/iad_sphere.json");
  const MeasuredSeries& series = read.series[0];
  ASSERT_EQ(series.points.size(), 6U);  // nothing unscattered was measured
  EXPECT_EQ(series.beam_diameter, 2.0);
  EXPECT_EQ(read.bands.wavelengths()[0], 550.0);
  EXPECT_EQ(series.points[0].value, 0.28);
  EXPECT_EQ(series.points[3].quantity, MeasuredQuantity::transmittance);
  EXPECT_EQ(series.points[3].value, 0.37);
  ASSERT_TRUE(series.points[0].sphere && series.points[3].sphere);
  const IntegratingSphere &above = *series.points[0].sphere, &below = *series.points[3].sphere;
  EXPECT_EQ(above.diameter, 100.0);
  EXPECT_EQ(above.sample_port, 12.0);
  EXPECT_EQ(above.entrance_port, 10.0);
  EXPECT_EQ(above.detector_port, 8.0);
  EXPECT_EQ(above.wall_reflectance, 0.97);
  EXPECT_EQ(above.standard_reflectance, 0.99);
  EXPECT_EQ(above.method, SphereMethod::substitution);
  EXPECT_EQ(below.entrance_port, 0.0);
  EXPECT_EQ(below.standard_reflectance, 0.97);  // the wall, opposite to the sample

  const Measurement totals = load_measurement(inputs / "good/iad_totals.json");
  ASSERT_EQ(totals.series[0].points.size(), 2U);
  EXPECT_FALSE(totals.series[0].points[0].sphere);
  EXPECT_EQ(totals.series[0].points[1].value, 0.42);
  const auto message_of = [](const std::string& name) {
    return refusal(inputs / ("bad/" + name + ".json"));
  };
  const std::string folder = (inputs / "bad/").string();
  EXPECT_EQ(message_of("iad_two_spheres"),
            folder +
                "iad_two_spheres.rxt:2: the number of spheres must be 0 or 1, but is 2: light "
                "that passes the sample between two spheres is not modelled");
  EXPECT_EQ(message_of("iad_some_zero"),
            folder +
                "iad_some_zero.rxt:7: transmittance is 0 in some lines, which iad takes for "
                "not measured, and not in others; write a file for each kind");
}

TEST(MeasurementFile, TakesInlineNumbers) {
  const Measurement measurement = load_measurement(inputs / "good/inline.json");
  ASSERT_EQ(measurement.series.size(), 1U);
  const MeasuredSeries& series = measurement.series[0];
  EXPECT_TRUE(series.has_specular);
  ASSERT_EQ(series.points.size(), 2U);
  EXPECT_EQ(series.points[1].quantity, MeasuredQuantity::transmittance);
  EXPECT_EQ(series.points[1].value, 0.2);
  EXPECT_EQ(series.points[1].standard_deviation, 0.01);
}

TEST(MeasurementFile, TakesTablesInPercent) {
  const Measurement measurement = load_measurement(inputs / "good/table.json");
  ASSERT_EQ(measurement.bands.size(), 2U);
  EXPECT_EQ(measurement.bands.wavelengths()[1], 550.0);
  EXPECT_TRUE(measurement.free[0].is_per_band);
  EXPECT_EQ(measurement.free[1].parameter.prior->standard_deviation, 0.3);
  const MeasuredSeries& series = measurement.series[0];
  EXPECT_FALSE(series.has_specular);
  EXPECT_NEAR(series.incidence.theta, 0.13962634, 1e-8);
  ASSERT_EQ(series.points.size(), 4U);
  EXPECT_EQ(series.points[1].band, 1U);
  EXPECT_NEAR(series.points[1].value, 0.31, 1e-15);
  EXPECT_NEAR(series.points[1].standard_deviation, std::hypot(0.002, 0.0031), 1e-15);
}

// Entries of different wavelengths: the bands are all of them.
TEST(MeasurementFile, PutsKindsTogether) {
  const Measurement measurement = load_measurement(inputs / "good/kinds.json");
  ASSERT_EQ(measurement.bands.size(), 2U);
  ASSERT_EQ(measurement.series.size(), 3U);
  EXPECT_EQ(measurement.series[1].points[1].band, 1U);
  EXPECT_EQ(measurement.series[1].points[1].at, 0.1);
  EXPECT_TRUE(measurement.series[1].incidence.is_diffuse);
  EXPECT_EQ(measurement.series[2].points[0].band, 0U);
  EXPECT_EQ(measurement.series[2].detector_width, 0.4);
}

std::string population_refusal(const fs::path& file) {
  try {
    (void)load_skin_population(file);
  } catch (const Error& error) {
    return error.what();
  }
  return "(taken)";
}

TEST(PopulationFile, EveryBadFileIsRefusedInOneLineThatNamesTheFault) {
  EXPECT_GT(expect_refusals(inputs.parent_path() / "population/bad", population_refusal), 10U);
}

TEST(PopulationFile, ComesBack) {
  const SkinPopulation& forearms = forearm_population();
  const fs::path file = fs::path(testing::TempDir()) / "forearms.json";
  std::ofstream(file) << format_skin_population(forearms, "Cooksey 2017");
  const SkinPopulation back = load_skin_population(file);
  fs::remove(file);
  EXPECT_EQ(back.names, forearms.names);
  EXPECT_EQ(back.correlation.values, forearms.correlation.values);
  EXPECT_EQ(back.missed, forearms.missed);
  EXPECT_EQ(back.missed_components.values, forearms.missed_components.values);
  EXPECT_EQ(back.priors[3].mean, forearms.priors[3].mean);
}

// What a population knows has its range, scale and prior, and starts at its mean.
TEST(MeasurementFile, TakesWhatAPopulationKnows) {
  const Measurement measurement = load_measurement(inputs / "good/population.json");
  ASSERT_EQ(measurement.free.size(), 2U);
  const FitParameter& melanin = measurement.free[0].parameter;
  EXPECT_EQ(melanin.prior->mean, 0.02);
  EXPECT_EQ(melanin.start, 0.02);
  EXPECT_EQ(melanin.high, 0.5);
  EXPECT_EQ(measurement.free[1].known, 1U);
  EXPECT_EQ(measurement.free[1].parameter.start, 0.5);
  const Material material =
      material_with(measurement, std::vector<std::vector<double>>{{0.1}, {0.3}});
  EXPECT_EQ(material.skin->skin.saturation_dermis, 0.3);
  EXPECT_EQ(material.skin->skin.saturation_epidermis, 0.3);
}

// Numbers of spheres may be one for each row.
TEST(MeasurementFile, GivesReadingsTheirSpheres) {
  const Measurement measurement = load_measurement(inputs / "good/spheres.json");
  const MeasuredSeries& series = measurement.series[0];
  EXPECT_EQ(series.beam_diameter, 2.0);
  ASSERT_EQ(series.points.size(), 6U);
  const IntegratingSphere& above = series.points[1].sphere.value();
  EXPECT_EQ(above.diameter, 100.0);
  EXPECT_EQ(above.sample_port, 10.0);
  EXPECT_EQ(above.detector_port, 8.0);
  EXPECT_EQ(above.entrance_port, 12.0);
  EXPECT_EQ(above.wall_reflectance, 0.96);
  EXPECT_EQ(above.detector_reflectance, 0.1);
  EXPECT_EQ(above.standard_reflectance, 0.99);
  EXPECT_EQ(above.method, SphereMethod::substitution);
  EXPECT_TRUE(above.has_baffle);
  const IntegratingSphere& below = series.points[2].sphere.value();
  EXPECT_EQ(below.open_port, 5.0);
  EXPECT_EQ(below.standard_reflectance, 0.95);  // the wall
  EXPECT_EQ(below.method, SphereMethod::comparison);
  EXPECT_FALSE(below.has_baffle);
  EXPECT_FALSE(series.points[4].sphere.has_value());  // what is unscattered
}

// Curves over time, what the instrument makes of them, and modulated light.
TEST(MeasurementFile, TakesTimesAndFrequencies) {
  const Measurement measurement = load_measurement(inputs / "good/timed.json");
  ASSERT_EQ(measurement.series.size(), 2U);
  const MeasuredSeries &curves = measurement.series[0], &waves = measurement.series[1];
  EXPECT_TRUE(curves.is_relative);
  EXPECT_EQ(curves.detector_width, 2.0);
  EXPECT_EQ(curves.points[3].r, 20.0);
  EXPECT_EQ(curves.points[3].at, 500.0);
  // A response of one point, times three nodes of a bin: mean 0, variance 12² / 12.
  ASSERT_EQ(curves.instrument.size(), 3U);
  double sum = 0.0, mean = 0.0, variance = 0.0;
  for (const auto& [delay, weight] : curves.instrument) {
    sum += weight;
    mean += weight * delay;
    variance += weight * delay * delay;
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_NEAR(mean, 0.0, 1e-12);
  EXPECT_NEAR(variance, 12.0, 1e-9);
  EXPECT_FALSE(waves.is_relative);
  EXPECT_NEAR(waves.points[0].value, 1e-4, 1e-18);
  EXPECT_EQ(waves.points[3].quantity, MeasuredQuantity::phase);
  EXPECT_EQ(waves.points[3].value, -345.0);
  EXPECT_EQ(waves.points[3].standard_deviation, 0.2);
}

// What is free is put in as --set would; what is not stays.
TEST(MeasurementFile, PutsNumbersIntoTheMaterial) {
  const Measurement measurement = load_measurement(inputs / "good/table.json");
  const std::vector<std::vector<double>> values = {{0.3, 0.4}, {2.5}};
  const Material material = material_with(measurement, values);
  EXPECT_EQ(material.bands, measurement.bands);
  EXPECT_EQ(material.layers[0].sigma_a, (std::vector{0.3, 0.4}));
  EXPECT_NEAR(sigma_s_prime(layer_stack(material, 1).layers()[0].medium), 2.5, 1e-12);
  EXPECT_EQ(material.layers[0].thickness, 2.0);
}

// Without a start, that of the material, by band where it has one for each.
TEST(MeasurementFile, StartsWhereTheMaterialIs) {
  const Measurement measurement = load_measurement(inputs / "good/starts.json");
  EXPECT_EQ(measurement.free[0].starts(2), (std::vector{0.1, 0.2}));
  EXPECT_EQ(measurement.free[1].starts(2), std::vector{1.5});
  const fit_detail::MeasurementModel model(measurement, {0, 1}, {}, {});
  EXPECT_EQ(model.parameters()[1].start, 0.2);
  EXPECT_EQ(model.parameters()[2].start, 1.5);
}

TEST(MeasurementFile, ChangesBySettings) {
  const std::vector<std::string> settings = {"free[0].start=0.7"};
  EXPECT_EQ(load_measurement(inputs / "good/inline.json", {}, settings).free[0].parameter.start,
            0.7);
}

}  // namespace
}  // namespace lamina
