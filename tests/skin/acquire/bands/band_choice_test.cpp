// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/bands/band_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/skin/fit/skin/skin_fit.h"

namespace lamina {
namespace {

const std::vector<std::string> five = {"melanin", "melanin_blend", "hemoglobin_epidermis",
                                       "hemoglobin_dermis", "carotene"};

std::vector<CandidateBand> every(double step) {
  std::vector<CandidateBand> bands;
  for (double nm = 400.0; nm <= 700.0; nm += step) bands.push_back({nm});
  return bands;
}

// Independent: the errors of a fit of the same bands, of which the information is the inverse.
TEST(BandInformation, HasTheErrorsOfAFit) {
  const std::vector<double> nm = {400.0, 420.0, 480.0, 580.0, 690.0};
  std::vector<CandidateBand> candidates;
  for (const double each : nm) candidates.push_back({each});
  const SkinParameters skin;
  const BandInformation information(
      candidates, {&skin, 1}, {"melanin", "hemoglobin_dermis", "saturation", "scattering_scale"},
      0.01);
  const BandSetRating rating = information.rate({0, 1, 2, 3, 4});

  const SkinReflectanceTable table(nm, {}, skin_fit_range(skin));
  SkinMeasurement measurement{.measured = table.reflectance(skin), .has_specular = false};
  for (const double r : measurement.measured) measurement.standard_deviation.push_back(0.01 * r);
  std::vector<SkinFitNumber> numbers;
  for (SkinFitNumber& number : skin_fit_numbers(skin))
    if (std::ranges::count(information.numbers(), number.parameter.name) > 0) {
      number.parameter.offset = 0.0;
      number.parameter.low = std::max(number.parameter.low, 1e-6);
      numbers.push_back(number);
    }
  const SkinFit fit = fit_skin(table, measurement, skin, numbers);
  for (std::size_t n = 0; n < 4; ++n)
    EXPECT_NEAR(rating.deviations[n], fit.fit.parameters[n].standard_deviation,
                1e-3 * rating.deviations[n]);
}

/// Every 10 nm.
const BandInformation& all_bands() {
  static const BandInformation information(every(10.0), skins_of_choice(), five, 0.005);
  return information;
}

// No exchange helps, and more bands tell more.
TEST(BandInformation, ChoosesTheBestSet) {
  const BandSetRating best = all_bands().choose(5);
  EXPECT_EQ(best.bands.size(), 5U);
  EXPECT_TRUE(std::ranges::is_sorted(best.bands));
  EXPECT_LT(best.score, 0.6 * all_bands().evenly_spaced(5).score);
  std::vector<std::size_t> six = best.bands;
  six.push_back(all_bands().candidates().size() - 1);
  EXPECT_LT(all_bands().rate(six).score, best.score);
  for (std::size_t place = 0; place < 5; ++place)
    for (std::size_t other = 0; other < all_bands().candidates().size(); ++other) {
      std::vector<std::size_t> set = best.bands;
      if (std::ranges::count(set, other) > 0) continue;
      set[place] = other;
      EXPECT_GE(all_bands().rate(set).score, best.score * (1.0 - 1e-12));
    }
  // The choice of another program with other constants of skin: 400 420 480 580 690 nm.
  const BandSetRating known = all_bands().rate({0, 2, 8, 18, 29});
  EXPECT_LE(best.score, known.score);
  EXPECT_LT(known.score, 1.05 * best.score);
}

// Beyond a million sets, by exchanges: as good as the best of all where both can be had.
TEST(BandInformation, ExchangesWhereSetsAreTooMany) {
  const BandSetRating nine = all_bands().choose(9), ten = all_bands().choose(10);
  EXPECT_EQ(ten.bands.size(), 10U);
  EXPECT_LT(ten.score, nine.score);
  EXPECT_LT(nine.score, all_bands().evenly_spaced(9).score);
}

TEST(BandInformation, WideBandsTellLess) {
  std::vector<CandidateBand> bands;
  for (const double width : {0.0, 2.0, 40.0})
    for (const double nm : {400.0, 420.0, 480.0, 580.0, 690.0}) bands.push_back({nm, width});
  const BandInformation information(bands, skins_of_choice(), five, 0.005);
  const double line = information.rate({0, 1, 2, 3, 4}).score;
  EXPECT_NEAR(information.rate({5, 6, 7, 8, 9}).score, line, 0.02 * line);
  EXPECT_GT(information.rate({10, 11, 12, 13, 14}).score, 1.2 * line);
}

TEST(BandInformation, SaysWhatIsNotTold) {
  EXPECT_TRUE(std::isinf(all_bands().rate({0, 1, 2}).score));
  EXPECT_THROW((void)all_bands().choose(4), InvalidInput);
  EXPECT_THROW((void)all_bands().choose(99), InvalidInput);
  EXPECT_THROW(BandInformation(every(20.0), skins_of_choice(), {"melanine"}, 0.005), InvalidInput);
  EXPECT_THROW(BandInformation({{200.0}}, skins_of_choice(), five, 0.005), InvalidInput);
}

// What is known before stays as it is where a band tells hardly more.
TEST(BandInformation, KnowsWhatIsKnownBefore) {
  const SkinPopulation& forearms = forearm_population();
  const SkinParameters skin;
  const BandInformation information({{950.0}}, {&skin, 1}, {"melanin", "carotene"}, 0.5, &forearms);
  const BandSetRating rating = information.choose(1);
  EXPECT_NEAR(rating.deviations[0], forearms.priors[0].standard_deviation, 0.01);
  EXPECT_NEAR(rating.deviations[1], forearms.priors[4].standard_deviation, 0.01);
}

// Means, standard deviations and correlation of drawn coordinates are those of the population.
TEST(DrawnSkins, AreOfThePopulation) {
  const SkinPopulation& forearms = forearm_population();
  const std::vector<SkinFitNumber> numbers = skin_fit_numbers({});
  constexpr int count = 4000;
  const std::vector<SkinParameters> skins = draw_skins(forearms, count, 4);
  const auto deviations_of = [&](std::size_t number) {  // over the prior's
    const FitParameter& parameter = numbers[number].parameter;
    const double mean = fit_coordinate(parameter, forearms.priors[number].mean);
    std::vector<double> deviations;
    for (const SkinParameters& skin : skins)
      deviations.push_back((fit_coordinate(parameter, skin.*numbers[number].values[0]) - mean) /
                           forearms.priors[number].standard_deviation);
    return deviations;
  };
  const auto mean_product = [&](const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0) / count;
  };
  const std::vector<double> ones(count, 1.0);
  for (const std::size_t number : {0U, 3U, 5U, 6U}) {
    const std::vector<double> deviations = deviations_of(number);
    EXPECT_NEAR(mean_product(deviations, ones), 0.0, 0.07) << number;
    EXPECT_NEAR(mean_product(deviations, deviations), 1.0, 0.1) << number;
    EXPECT_NEAR(mean_product(deviations, deviations_of(0)), forearms.correlation(number, 0),
                number == 0 ? 0.1 : 0.07)
        << number;
  }
}

}  // namespace
}  // namespace lamina
