// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/skin/skin_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "skin/fit/normal_number.h"

namespace lamina {
namespace {

constexpr Incidence beam{.theta = 8.0 * std::numbers::pi / 180.0};

/// 400 to 700 nm, 20 nm apart.
const std::vector<double>& wavelengths() {
  static const std::vector<double> nm = [] {
    std::vector<double> made;
    for (int i = 0; i <= 15; ++i) made.push_back(400.0 + 20.0 * i);
    return made;
  }();
  return nm;
}
const SkinReflectanceTable& table() {
  static const SkinReflectanceTable made(wavelengths(), beam, skin_fit_range({}));
  return made;
}

/// Any skin of the range, most of it such as people have.
SkinParameters any_skin(Random& random) {
  const auto between = [&](double low, double high) {
    return low * std::pow(high / low, random.uniform());
  };
  SkinParameters skin;
  skin.melanin = between(1e-3, 0.5);
  skin.melanin_blend = random.uniform();
  skin.hemoglobin_epidermis = between(1e-5, 0.05);
  skin.hemoglobin_dermis = between(1e-4, 0.1);
  skin.carotene = between(1e-6, 0.05);
  skin.saturation_dermis = skin.saturation_epidermis = random.uniform();
  skin.baseline_scale = between(1e-3, 2.0);
  skin.scattering_scale = between(0.3, 3.0);
  return skin;
}

// Independent: the stack itself, on its own grid, refined until it is right to 1e-7.
TEST(SkinReflectanceTable, GivesWhatAddingDoublingGives) {
  Random random = make_random(5, 0);
  double squares = 0.0, largest = 0.0;
  constexpr int skins = 24;
  for (int i = 0; i < skins; ++i) {
    const SkinParameters skin = any_skin(random);
    const std::size_t w = static_cast<std::size_t>(i) % wavelengths().size();
    const double direct =
        adding_doubling(skin_layer_stack(skin, wavelengths()[w]), beam, {.accuracy = 1e-6})
            .totals.diffuse_reflectance;
    const double error = table().reflectance(skin)[w] / direct - 1.0;
    squares += error * error;
    largest = std::max(largest, std::abs(error));
  }
  EXPECT_LT(std::sqrt(squares / skins), 3e-4);
  EXPECT_LT(largest, 1.5e-3);
}

TEST(SkinReflectanceTable, TakesDiffuseLightAndAnyThickness) {
  SkinParameters thin;
  thin.epidermis_thickness = 0.06;
  thin.junction_absorption = 0.0;
  const SkinReflectanceTable diffuse({550.0}, {.is_diffuse = true}, skin_fit_range(thin));
  const SlabTotals direct =
      adding_doubling(skin_layer_stack(thin, 550.0), {.is_diffuse = true}, {.accuracy = 1e-7})
          .totals;
  EXPECT_NEAR(diffuse.reflectance(thin)[0], direct.diffuse_reflectance, 3e-4);
  EXPECT_NEAR(diffuse.specular_reflectance(), direct.specular_reflectance, 1e-6);
}

TEST(SkinReflectanceTable, HasTheDerivativesOfItsDifferences) {
  SkinParameters skin;
  const std::array numbers = {&SkinParameters::melanin,
                              &SkinParameters::melanin_blend,
                              &SkinParameters::hemoglobin_dermis,
                              &SkinParameters::saturation_dermis,
                              &SkinParameters::baseline_scale,
                              &SkinParameters::scattering_scale,
                              &SkinParameters::epidermis_thickness};
  DenseMatrix derivatives;
  const std::vector<double> value = table().reflectance(skin, numbers, derivatives);
  EXPECT_EQ(value, table().reflectance(skin));
  for (std::size_t n = 0; n + 1 < numbers.size(); ++n) {  // the thickness is fixed in this table
    SkinParameters more = skin, less = skin;
    const double step = 1e-4 * skin.*numbers[n];
    more.*numbers[n] += step;
    less.*numbers[n] -= step;
    const auto above = table().reflectance(more), below = table().reflectance(less);
    for (std::size_t w = 0; w < value.size(); ++w) {
      const double difference = (above[w] - below[w]) / (2.0 * step);
      EXPECT_NEAR(derivatives(w, n), difference, 1e-6 * std::abs(difference) + 1e-9)
          << n << " " << w;
    }
  }
}

std::string refusal(const SkinRange& range, std::vector<double> nm = {500.0}) {
  try {
    (void)SkinReflectanceTable(std::move(nm), beam, range);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

TEST(SkinReflectanceTable, RefusesWhatItCannotHold) {
  SkinRange range = skin_fit_range({});
  range.high.melanin = -0.1;
  EXPECT_EQ(refusal(range), "range of melanin: must lie within [0, 0.5], but is [0, -0.1]");
  range = skin_fit_range({});
  range.low.dermis_thickness = range.high.dermis_thickness = 2.0;
  EXPECT_EQ(refusal(range),
            "dermis_thickness: must be infinite for a table of reflectance, but is 2 mm");
  EXPECT_NE(refusal(skin_fit_range({}), {200.0}).find("200"), std::string::npos);
  EXPECT_NE(refusal(skin_fit_range({}), {std::nan("")}), "");
}

// Spectra of the solver itself, not of the table.
TEST(SkinFit, FindsTheSkinThatASpectrumIsOf) {
  Random random = make_random(7, 0);
  const std::vector<SkinFitNumber> numbers = skin_fit_numbers({});
  for (int i = 0; i < 3; ++i) {
    SkinParameters truth;
    truth.melanin = 0.01 + 0.04 * random.uniform();
    truth.hemoglobin_epidermis = 0.001 + 0.002 * random.uniform();
    truth.hemoglobin_dermis = 0.003 + 0.01 * random.uniform();
    truth.saturation_dermis = truth.saturation_epidermis = 0.5 + 0.3 * random.uniform();
    truth.scattering_scale = 0.5 + 0.4 * random.uniform();
    SkinMeasurement measurement;
    for (const double nm : wavelengths()) {
      const SlabTotals totals =
          adding_doubling(skin_layer_stack(truth, nm), beam, {.accuracy = 1e-6}).totals;
      measurement.measured.push_back(totals.specular_reflectance + totals.diffuse_reflectance);
    }
    measurement.standard_deviation.assign(wavelengths().size(), 1e-4);
    const SkinFit found = fit_skin(table(), measurement, {}, numbers);
    EXPECT_TRUE(found.fit.has_converged);
    EXPECT_NEAR(found.skin.melanin, truth.melanin, 0.02 * truth.melanin);
    EXPECT_NEAR(found.skin.hemoglobin_dermis, truth.hemoglobin_dermis,
                0.03 * truth.hemoglobin_dermis);
    EXPECT_NEAR(found.skin.saturation_dermis, truth.saturation_dermis, 0.02);
    EXPECT_NEAR(found.skin.scattering_scale, truth.scattering_scale, 0.02 * truth.scattering_scale);
    for (std::size_t w = 0; w < wavelengths().size(); ++w)
      EXPECT_NEAR(found.spectrum[w], measurement.measured[w], 3e-4);
  }
}

// Skins drawn from the population, none at a bound, measured with noise, the model's own errors
// among it: the error bars hold what they say.
TEST(SkinFit, HasHonestErrorBars) {
  const SkinPopulation& population = forearm_population();
  const std::vector<SkinFitNumber> numbers = skin_fit_numbers({});
  const std::size_t n = numbers.size();
  ASSERT_EQ(population.priors.size(), n);
  DenseMatrix factor(n, n);  // Cholesky's of the correlation
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = population.correlation(i, j);
      for (std::size_t k = 0; k < j; ++k) sum -= factor(i, k) * factor(j, k);
      factor(i, j) = i == j ? std::sqrt(sum) : sum / factor(j, j);
    }
  constexpr double error = 0.003;
  constexpr int measurements = 1500;
  Random random = make_random(11, 0);
  std::vector<int> within_one(n), within_two(n), known(n);
  int used = 0;
  while (used < measurements) {
    std::vector<double> z(n), u(n), values(n);
    for (double& each : z) each = normal_number(random);
    bool is_inside = true;
    for (std::size_t i = 0; i < n; ++i) {
      const FitParameter& parameter = numbers[i].parameter;
      u[i] = fit_coordinate(parameter, population.priors[i].mean);
      for (std::size_t j = 0; j <= i; ++j)
        u[i] += population.priors[i].standard_deviation * factor(i, j) * z[j];
      values[i] = fit_value(parameter, u[i]);
      is_inside = is_inside && values[i] > parameter.low && values[i] < parameter.high;
    }
    if (!is_inside) continue;
    SkinMeasurement measurement;
    measurement.measured = table().reflectance(with_numbers({}, numbers, values));
    std::vector<double> part(population.missed_components.rows);
    for (double& each : part) each = normal_number(random);
    for (std::size_t w = 0; w < wavelengths().size(); ++w) {
      double& r = measurement.measured[w];
      r += table().specular_reflectance() + error * normal_number(random) +
           at_wavelength(population, population.missed, wavelengths()[w]);
      for (std::size_t c = 0; c < part.size(); ++c)
        r += part[c] *
             at_wavelength(population, population.missed_components.row(c), wavelengths()[w]);
    }
    measurement.standard_deviation.assign(wavelengths().size(), error);
    const SkinFit found =
        fit_skin(table(), measurement, {}, numbers, &population, {.tolerance = 1e-6});
    ++used;
    for (std::size_t i = 0; i < n; ++i) {
      const FittedParameter& fitted = found.fit.parameters[i];
      if (fitted.is_at_bound) continue;  // it is unknown
      ++known[i];
      const double off = std::abs(fit_coordinate(numbers[i].parameter, fitted.value) - u[i]);
      within_one[i] += off < fitted.standard_deviation;
      within_two[i] += off < 2.0 * fitted.standard_deviation;
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_GE(known[i], 0.9 * used) << population.names[i];
    EXPECT_GE(within_one[i], 0.60 * known[i]) << population.names[i];
    EXPECT_GE(within_two[i], 0.93 * known[i]) << population.names[i];
    // Those that ended at their range had noise that led far: without them errors hold more.
    if (known[i] < used) continue;
    EXPECT_LE(within_one[i], 0.75 * used) << population.names[i];
    EXPECT_LE(within_two[i], 0.975 * used) << population.names[i];
  }
}

TEST(SkinFit, SaysWhatAColorDoesNotTell) {
  const std::size_t points = wavelengths().size();
  DenseMatrix sensor(3, points);  // red, green, blue
  for (std::size_t w = 0; w < points; ++w) sensor(w > 10 ? 0 : w > 4 ? 1 : 2, w) = 0.2;
  SkinParameters truth;
  truth.melanin = 0.02;
  std::vector<double> seen(3, 0.0);
  const std::vector<double> spectrum = table().reflectance(truth);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t w = 0; w < points; ++w)
      seen[c] += sensor(c, w) * (spectrum[w] + table().specular_reflectance());
  const SkinFit found = fit_skin(
      table(), {.measured = seen, .standard_deviation = {0.004, 0.004, 0.004}, .sensor = sensor},
      {}, skin_fit_numbers({}), &forearm_population());
  EXPECT_LT(found.fit.parameters[0].prior_share, 0.5);  // melanin
  EXPECT_GT(found.fit.parameters[2].prior_share, 0.8);  // hemoglobin_epidermis
  EXPECT_TRUE(std::ranges::any_of(found.fit.notes, [](const std::string& note) {
    return note == "hemoglobin_epidermis: from the prior, the data add little";
  }));
  EXPECT_THROW(
      (void)fit_skin(table(), {.measured = {0.5}, .standard_deviation = {0.1}, .sensor = sensor},
                     {}, skin_fit_numbers({})),
      InvalidInput);
}

}  // namespace
}  // namespace lamina
