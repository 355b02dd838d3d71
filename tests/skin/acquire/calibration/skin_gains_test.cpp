// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/skin_gains.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "lamina/base/core/error.h"
#include "lamina/base/core/symmetric_eigen.h"
#include "lamina/base/io/csv_table.h"
#include "lamina/skin/fit/skin/skin_fit.h"
#include "skin/acquire/calibration/synthetic_images.h"

namespace lamina {
namespace {

/// Much in common, as people's skin is light or dark.
SkinColors some_colors() {
  SkinColors colors{.mean = {std::log(0.5), std::log(0.3), std::log(0.2)},
                    .covariance = DenseMatrix(3, 3)};
  constexpr std::array<double, 3> level = {0.15, 0.25, 0.3}, own = {0.05, 0.06, 0.08};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      colors.covariance(i, j) = level[i] * level[j] + (i == j ? own[i] * own[i] : 0.0);
  return colors;
}

/// A person's color, through gains that are drawn from the prior.
struct Draw {
  std::array<double, 3> log_gains{};
  std::vector<std::vector<double>> people;
};

Draw draw(const SkinColors& colors, const SkinGainPrior& prior, int people, std::uint64_t index) {
  Random random = make_random(11, index);
  const SymmetricEigen eigen = symmetric_eigen(colors.covariance);
  const double level = prior.level * normal_number(random);
  Draw result;
  for (double& gain : result.log_gains) gain = level + prior.color * normal_number(random);
  for (int p = 0; p < people; ++p) {
    std::vector<double> person;
    for (std::size_t c = 0; c < 3; ++c) person.push_back(colors.mean[c] - result.log_gains[c]);
    for (std::size_t k = 0; k < 3; ++k) {
      const double size = std::sqrt(eigen.values[k]) * normal_number(random);
      for (std::size_t c = 0; c < 3; ++c) person[c] += size * eigen.vectors(c, k);
    }
    result.people.push_back(person);
  }
  return result;
}

// Over draws, errors have the covariance that is said, whatever the number of people.
TEST(SkinGains, KnowTheirErrors) {
  const SkinColors colors = some_colors();
  const SkinGainPrior prior{.level = 0.6, .color = 0.2, .widening = 1.0};
  for (const int people : {1, 5}) {
    double squares = 0.0, distances = 0.0;
    constexpr int count = 400;
    for (int i = 0; i < count; ++i) {
      const Draw truth = draw(colors, prior, people, static_cast<std::uint64_t>(i));
      const SkinGains found = fit_skin_gains(truth.people, colors, prior);
      DenseMatrix error(3, 1);
      for (std::size_t c = 0; c < 3; ++c)
        error(c, 0) = std::log(found.gains[c]) - truth.log_gains[c];
      const DenseMatrix x = solve_linear(found.covariance, error);
      for (std::size_t c = 0; c < 3; ++c) squares += error(c, 0) * x(c, 0) / (3 * count);
      distances += found.distance / count;
    }
    EXPECT_NEAR(squares, 1.0, 0.15) << people;
    EXPECT_NEAR(distances, 1.0, 0.1);
  }
}

TEST(SkinGains, AreToldBetterByMorePeople) {
  const SkinColors colors = some_colors();
  const auto share = [&](int people) {
    return fit_skin_gains(draw(colors, {}, people, 1).people, colors, {.widening = 1.0})
        .prior_share[2];
  };
  EXPECT_LT(share(1), 0.6);
  EXPECT_LT(share(9), 0.4 * share(1));
  // Far from all skin: said so.
  const std::vector<std::vector<double>> green = {{-4.0, -0.5, -4.0}};
  EXPECT_GT(fit_skin_gains(green, colors).distance, 2.5);
}

TEST(SkinGains, OfAnImageBringItsColorsToSkin) {
  const SkinColors colors = some_colors();
  constexpr std::array<float, 3> gains = {0.6f, 1.1f, 1.9f};
  Image image = image_of(60, 50, {"R", "G", "B"}, [&](double x, double y, std::size_t c) {
    return std::exp(colors.mean[c]) * skin_texture(x, y, 0.05) / static_cast<double>(gains[c]);
  });
  const PixelMask all = make_pixel_mask(60, 50);
  PixelMask skin = all;
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 50; ++y) {
      skin.mark(skin.index(x, y), PixelFault::excluded);
      image.at(x, y)[1] = x < 10 ? -1.0f : 0.9f;  // a shirt
    }
  const std::vector<std::vector<double>> person = {median_log_color(image, skin)};
  const SkinGains found = fit_skin_gains(person, colors);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(std::log(found.gains[c] / static_cast<double>(gains[c])), 0.0,
                2.0 * std::sqrt(found.covariance(c, c)));
  EXPECT_EQ(pixels_of_skin(image, skin, std::vector{1.0, 1.0, 1.0}, colors).skin, 0u);
  EXPECT_EQ(pixels_of_skin(image, skin, found.gains, colors).skin, 2000u);
  EXPECT_EQ(pixels_of_skin(image, all, found.gains, colors).skin, 2000u);

  PixelMask none = all;
  for (auto& fault : none.faults) fault = 1;
  EXPECT_THROW((void)median_log_color(image, none), InvalidInput);
  EXPECT_THROW((void)fit_skin_gains({}, colors), InvalidInput);
  EXPECT_THROW((void)fit_skin_gains(std::vector<std::vector<double>>{{0.1, 0.2}}, colors),
               InvalidInput);
  EXPECT_THROW((void)fit_skin_gains(person, colors, {.level = 0.0}), InvalidInput);
}

// Against the measurements that the population was made of: 100 forearms, the mirrored light
// included.
// A quarter of skin among black hair and an orange suit: the middle of all is none of them.
TEST(SkinGains, AreFoundAmongWhatIsNoSkin) {
  const SkinColors colors = some_colors();
  const std::array<double, 3> camera = {0.7, 0.85, 1.1};
  Image image = make_image(60, 60, {"R", "G", "B"});
  Random random = make_random(2, 1);
  std::array<std::size_t, 3> count = {};
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) {
      const std::size_t kind = y < 15 ? 0u : y < 35 ? 1u : 2u;
      constexpr std::array<std::array<double, 3>, 3> of_kind = {
          {{0.5, 0.3, 0.2}, {0.02, 0.018, 0.015}, {0.75, 0.13, 0.02}}};
      ++count[kind];
      for (std::size_t c = 0; c < 3; ++c)
        image.at(x, y)[c] = static_cast<float>(of_kind[kind][c] * camera[c] *
                                               std::exp(0.04 * normal_number(random)));
    }
  const PixelMask all = make_pixel_mask(60, 60);
  const FoundSkinGains found = find_skin_gains(image, all, colors);
  for (std::size_t c = 0; c < 3; ++c) {
    const double error = std::sqrt(found.gains.covariance(c, c));
    EXPECT_LT(std::abs(std::log(found.gains.gains[c] * camera[c])), error) << c;
  }
  EXPECT_LT(found.gains.distance, 1.5);
  EXPECT_NEAR(static_cast<double>(found.pixels.skin), static_cast<double>(count[0]), 20.0);
  EXPECT_EQ(found.pixels.dark, count[1]);
  EXPECT_EQ(found.pixels.colored, count[2]);
  EXPECT_EQ(count_pixels(found.pixels.mask).used, found.pixels.skin);
  // By the middle of all, skin is none.
  const std::vector<double> seen = median_log_color(image, all);
  const SkinGains of_all = fit_skin_gains({&seen, 1}, colors);
  EXPECT_LT(static_cast<double>(pixels_of_skin(image, all, of_all.gains, colors).skin),
            0.05 * static_cast<double>(count_pixels(all).used));
}

TEST(SkinColors, AreThoseOfMeasuredForearms) {
  const std::vector<double> nm = {451.0, 550.0, 640.0};
  const SkinReflectanceTable table(nm, {}, skin_fit_range({}));
  DenseMatrix sensor(3, 3);
  for (std::size_t i = 0; i < 3; ++i) sensor(i, i) = 1.0;
  const SkinColors drawn = make_skin_colors(table, sensor, forearm_population(), true, 2000, 3);
  EXPECT_THROW((void)make_skin_colors(table, DenseMatrix(3, 2), forearm_population(), true, 200, 3),
               InvalidInput);
  EXPECT_THROW((void)make_skin_colors(table, sensor, forearm_population(), true, 9, 3),
               InvalidInput);

  const std::filesystem::path file =
      std::filesystem::path(LAMINA_SHARED_DATA) / "skin/nist_skin_reflectance_mean_vis.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  MemoryBudget memory;
  const CsvTable measured = load_csv(file, memory);
  for (std::size_t row = 0; row < measured.rows(); ++row)
    for (std::size_t c = 0; c < 3; ++c) {
      if (measured.number(row, 0) != nm[c]) continue;
      std::vector<double> logs;
      for (std::size_t p = 1; p < measured.columns().size(); ++p)
        logs.push_back(std::log(measured.number(row, p)));
      std::ranges::sort(logs);
      const std::size_t people = logs.size();
      const double deviation = 0.5 * (logs[people * 84 / 100] - logs[people * 16 / 100]);
      EXPECT_NEAR(drawn.mean[c], logs[people / 2], 0.7 * deviation) << nm[c];
      EXPECT_NEAR(std::sqrt(drawn.covariance(c, c)), deviation, 0.35 * deviation) << nm[c];
    }
}

}  // namespace
}  // namespace lamina
