// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/lookup/skin_lookup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/skin/acquire/bands/band_choice.h"

namespace lamina {
namespace {

/// Colors of eight wavelengths, for which a table is quick to make.
struct Study {
  std::vector<double> wavelengths = {400.0, 440.0, 480.0, 520.0, 560.0, 600.0, 650.0, 700.0};
  SkinReflectanceTable table{wavelengths, {.is_diffuse = true}, skin_fit_range({})};
  ColorMeasurement measurement = [this] {
    ColorMeasurement made{.sensor = DenseMatrix(3, wavelengths.size()),
                          .errors = {0.02, 0.02, 0.02}};
    const BandWeights weights = make_band_weights(BandSet(wavelengths));
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t w = 0; w < wavelengths.size(); ++w) made.sensor(c, w) = weights[w][c];
    return made;
  }();
  std::vector<SkinFitNumber> numbers = skin_fit_numbers({});
  SkinLookup colors{table, measurement, {}, numbers, forearm_population(), 9};

  [[nodiscard]] std::vector<double> color_of(const std::vector<double>& spectrum) const {
    std::vector<double> color(3, 0.0);
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t w = 0; w < spectrum.size(); ++w)
        color[c] += measurement.sensor(c, w) * spectrum[w];
    return color;
  }
};
const Study& study() {
  static const Study made;
  return made;
}

std::array<float, 3> floats(const std::vector<double>& color) {
  return {static_cast<float>(color[0]), static_cast<float>(color[1]), static_cast<float>(color[2])};
}

// Independent: the fit itself, at colors between the nodes.
TEST(SkinLookup, HasTheFitsOfColors) {
  std::vector<double> apart;  // in standard deviations
  for (const SkinParameters& skin : draw_skins(forearm_population(), 40, 3)) {
    const std::vector<double> color = study().color_of(study().table.reflectance(skin));
    SkinMeasurement seen{.measured = color,
                         .standard_deviation = {0.02 * color[0], 0.02 * color[1], 0.02 * color[2]},
                         .sensor = study().measurement.sensor,
                         .has_specular = false};
    const FitResult fit =
        fit_skin(study().table, seen, {}, study().numbers, &forearm_population()).fit;
    const ColorFit found = study().colors.at(floats(color));
    for (std::size_t n = 0; n < study().numbers.size(); ++n) {
      if (fit.parameters[n].is_at_bound) continue;
      const double deviation = fit.parameters[n].standard_deviation;
      const FitParameter& parameter = study().numbers[n].parameter;
      apart.push_back(std::abs(fit_coordinate(parameter, static_cast<double>(found.values[n])) -
                               fit_coordinate(parameter, fit.parameters[n].value)) /
                      deviation);
      EXPECT_NEAR(static_cast<double>(found.deviations[n]) / deviation, 1.0, 0.2) << parameter.name;
    }
    EXPECT_NEAR(static_cast<double>(found.distance), std::sqrt(fit.chi_squared + fit.prior_squares),
                0.5);
  }
  std::ranges::sort(apart);
  EXPECT_LT(apart[apart.size() / 2], 0.05);
  EXPECT_LT(apart.back(), 0.6);
}

// People as the prior has them, model errors and noise included: one standard deviation holds two
// thirds of the truths.
TEST(SkinLookup, ErrorsCoverTheTruthAsOftenAsTheySay) {
  const SkinPopulation& population = forearm_population();
  Random random = make_random(11, 0);
  const auto normal = [&] {
    return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) *
           std::cos(2.0 * std::numbers::pi * random.uniform());
  };
  const std::vector<SkinParameters> people = draw_skins(population, 600, 5);
  std::vector<double> within(study().numbers.size(), 0.0);
  for (const SkinParameters& skin : people) {
    std::vector<double> spectrum = study().table.reflectance(skin);
    std::vector<double> shares;
    for (std::size_t c = 0; c < population.missed_components.rows; ++c) shares.push_back(normal());
    for (std::size_t w = 0; w < spectrum.size(); ++w) {
      spectrum[w] += at_wavelength(population, population.missed, study().wavelengths[w]);
      for (std::size_t c = 0; c < shares.size(); ++c)
        spectrum[w] += shares[c] * at_wavelength(population, population.missed_components.row(c),
                                                 study().wavelengths[w]);
    }
    std::vector<double> color = study().color_of(spectrum);
    for (double& channel : color) channel *= 1.0 + 0.02 * normal();
    const ColorFit found = study().colors.at(floats(color));
    for (std::size_t n = 0; n < within.size(); ++n) {
      const FitParameter& parameter = study().numbers[n].parameter;
      const double truth = fit_coordinate(parameter, skin.*study().numbers[n].values[0]);
      if (std::abs(fit_coordinate(parameter, static_cast<double>(found.values[n])) - truth) <
          static_cast<double>(found.deviations[n]))
        within[n] += 1.0 / static_cast<double>(people.size());
    }
  }
  for (std::size_t n = 0; n < within.size(); ++n) {
    EXPECT_GT(within[n], 0.60) << study().numbers[n].parameter.name;
    EXPECT_LT(within[n], study().numbers[n].parameter.name == "carotene" ? 0.86 : 0.76)  // many: 0
        << study().numbers[n].parameter.name;
  }
}

TEST(SkinLookup, KnowsColorsThatAreNoSkin) {
  const auto distance = [](float r, float g, float b) {
    return study().colors.at({r, g, b}).distance;
  };
  EXPECT_LT(distance(0.45f, 0.29f, 0.22f), 6.0f);
  EXPECT_LT(distance(0.12f, 0.06f, 0.035f), 8.0f);  // dark skin
  EXPECT_GT(distance(0.1f, 0.3f, 0.1f), farthest_skin);
  EXPECT_GT(distance(0.1f, 0.1f, 0.4f), farthest_skin);
  EXPECT_GT(distance(0.0f, 0.0f, 0.0f), farthest_skin);
  EXPECT_GT(distance(1e30f, 1e30f, 1e30f), farthest_skin);
  for (const float value : study().colors.at({0.0f, 1e30f, 0.0f}).values)
    EXPECT_TRUE(std::isfinite(value));
}

// Half as bright as skin that is darker than anybody's is no skin, as by the fit of the color.
TEST(SkinLookup, KnowsColorsThatAreTooDark) {
  SkinParameters darkest;
  darkest.melanin = 0.4;
  std::vector<double> color = study().color_of(study().table.reflectance(darkest));
  for (double& channel : color) channel *= 0.5;
  const ColorFit found = study().colors.at(floats(color));
  EXPECT_GT(found.distance, farthest_skin);
  EXPECT_EQ(found.side, ColorSide::dark);
}

// Pixels of skin do not become more where errors have grown; numbers become less sure.
TEST(SkinLookup, KeepsDistancesWhereErrorsGrow) {
  ColorMeasurement grown = study().measurement;
  grown.error_growth = {4.0, 4.0, 4.0};
  const auto at = [&](const ColorMeasurement& measurement) {
    const SkinLookup table(study().table, measurement, {}, study().numbers,
                               forearm_population(), 5);
    return table.at({0.45f, 0.29f, 0.22f});
  };
  const ColorFit stated = at(study().measurement), found = at(grown);
  EXPECT_EQ(found.distance, stated.distance);
  EXPECT_GT(found.deviations[0], 1.2f * stated.deviations[0]);
}

TEST(SkinLookup, RefusesWhatItCannotUse) {
  const auto message = [](ColorMeasurement measurement, std::vector<SkinFitNumber> numbers,
                          int fits) -> std::string {
    try {
      const SkinLookup table(study().table, measurement, {}, std::move(numbers),
                                 forearm_population(), fits);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  ColorMeasurement narrow = study().measurement;
  narrow.sensor = DenseMatrix(3, 2);
  EXPECT_EQ(message(narrow, study().numbers, 5),
            "sensor: must have 3 rows and a column for each of 8 wavelengths, but has 3 and 2");
  ColorMeasurement exact = study().measurement;
  exact.errors[1] = 0.0;
  EXPECT_EQ(message(exact, study().numbers, 5), "errors: must be in [1e-4, 0.5], but one is 0");
  EXPECT_EQ(message(study().measurement, {}, 5), "numbers: must be 1 to 8, but are 0");
  EXPECT_EQ(message(study().measurement, study().numbers, 3), "fits: must be in [4, 33], but is 3");
  std::vector<SkinFitNumber> unknown = study().numbers;
  unknown[0].parameter.name = "tan";
  EXPECT_EQ(message(study().measurement, unknown, 5), "tan: the population knows nothing of it");
}

}  // namespace
}  // namespace lamina
