// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"

namespace lamina {
namespace {

double gaussian(Random& random) {  // Box and Muller
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * random.uniform());
}

/// A gradient with noise whose variance grows with the light, as that of renders.
RenderEstimate render(std::uint64_t seed, int size, double noise) {
  RenderEstimate estimate{make_image(size, size, {"R", "G", "B"}),
                          make_image(size, size, {"R", "G", "B"})};
  for (std::size_t i = 0; i < estimate.mean.pixels.size(); ++i) {
    Random random = make_random(seed, i);
    const double light =
        0.5 + static_cast<double>(i) / static_cast<double>(estimate.mean.pixels.size());
    const double variance = noise * noise * light;
    estimate.mean.pixels[i] = static_cast<float>(light + std::sqrt(variance) * gaussian(random));
    estimate.variance.pixels[i] = static_cast<float>(variance);
  }
  return estimate;
}

TEST(CompareRenders, OfOneSceneAgree) {
  for (std::uint64_t seed = 0; seed < 20;
       ++seed) {  // 2 % chance of one failure; the seeds are fixed
    const ImageComparison comparison =
        compare_renders(render(2 * seed, 64, 0.05), render(2 * seed + 1, 64, 0.05));
    EXPECT_TRUE(comparison.agrees) << comparison.report();
    EXPECT_NEAR(comparison.mean_square_z, 1.0, 5.0 * std::sqrt(2.0 / (64.0 * 64.0 * 3.0)));
  }
}

TEST(CompareRenders, FalseAlarmsAreAsRareAsPromised) {
  int alarms = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed)
    if (!compare_renders(render(2 * seed, 8, 0.05), render(2 * seed + 1, 8, 0.05), 0.1).agrees)
      ++alarms;
  EXPECT_LE(alarms, 40 + 3 * 6);  // 10 % of 400, three standard deviations of 6
  EXPECT_GE(alarms, 40 - 4 * 6);  // and the test is not much stricter than it says
}

TEST(CompareRenders, OneWrongPixelIsFound) {
  RenderEstimate wrong = render(1, 64, 0.05);
  wrong.mean.at(10, 20)[1] += 0.05f * 8.0f;
  const ImageComparison comparison = compare_renders(wrong, render(2, 64, 0.05));
  EXPECT_FALSE(comparison.agrees);
  EXPECT_EQ(comparison.differing, 1u);
  EXPECT_LT(comparison.p_values.at(10, 20)[0], comparison.threshold);
}

TEST(CompareRenders, ABiasBelowTheNoiseOfPixelsIsFound) {
  RenderEstimate biased = render(1, 64, 0.05);
  for (float& value : biased.mean.pixels) value *= 1.005f;  // a tenth of the noise
  const ImageComparison comparison = compare_renders(biased, render(2, 64, 0.05));
  EXPECT_FALSE(comparison.agrees);
  EXPECT_EQ(comparison.differing, 0u);
  EXPECT_GT(comparison.bias_z, 5.0);
}

TEST(CompareRenders, WithoutNoiseOnlyEqualImagesAgree) {
  RenderEstimate exact = render(1, 8, 0.0);
  EXPECT_TRUE(compare_renders(exact, exact).agrees);
  RenderEstimate other = exact;
  other.mean.pixels[5] += 1e-3f;
  EXPECT_FALSE(compare_renders(exact, other).agrees);
}

TEST(CompareRenders, RefusesImagesThatCannotBeCompared) {
  const RenderEstimate good = render(1, 8, 0.1);
  EXPECT_THROW((void)compare_renders(good, render(1, 9, 0.1)), InvalidInput);
  RenderEstimate bad = good;
  bad.variance.pixels[3] = -1.0f;
  EXPECT_THROW((void)compare_renders(good, bad), InvalidInput);
  bad = good;
  bad.mean.pixels[3] = std::nanf("");
  EXPECT_THROW((void)compare_renders(good, bad), InvalidInput);
  EXPECT_THROW((void)compare_renders({}, {}), InvalidInput);
}

TEST(RootMeanSquareDifference, IsThatOfTheNumbers) {
  Image a = make_image(2, 1, {"Y"}), b = a;
  b.pixels = {3.0f, 4.0f};
  EXPECT_DOUBLE_EQ(root_mean_square_difference(a, b), std::sqrt(12.5));
}

// Gaussian noise s: the residual has deviation s sqrt(1 + 1/4), its median is 0.6745 of that.
TEST(RelativeNoise, IsThreeQuartersOfTheStandardDeviation) {
  Image image = make_image(200, 200, {"Y"});
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    Random random = make_random(5, i);
    image.pixels[i] = static_cast<float>(2.0 + 0.1 * gaussian(random));
  }
  EXPECT_NEAR(relative_noise(image, std::vector<bool>(40000, true)).value(), 0.754 * 0.05,
              0.001);  // 40000 values: 1 % of the median
}

TEST(RelativeNoise, LooksOnlyInsideTheMask) {
  Image image = make_image(9, 9, {"R", "G", "B"});
  std::vector<bool> mask(81);
  const std::vector<bool> all(81, true);
  for (std::size_t i = 0; i < 81; ++i) {
    const bool is_left = i % 9 < 4;
    mask[i] = is_left;
    for (std::size_t c = 0; c < 3; ++c)
      image.pixels[3 * i + c] = is_left ? 1.0f : static_cast<float>(i * i % 7);
  }
  EXPECT_EQ(relative_noise(image, mask), 0.0);
  EXPECT_GT(relative_noise(image, all).value(), 0.0);
  EXPECT_FALSE(relative_noise(make_image(9, 9, {"Y"}), all));  // black
  EXPECT_THROW((void)relative_noise(image, std::vector<bool>(80)), InvalidInput);
}

/// Independent noise of deviation s of the light 2, with its variance.
Image noisy_image(double s) {
  Image image = make_image(200, 200, {"R", "G", "B", "variance"});
  for (std::size_t i = 0; i < 40000; ++i) {
    Random random = make_random(5, i);
    const auto value = static_cast<float>(2.0 * (1.0 + s * gaussian(random)));
    for (std::size_t c = 0; c < 3; ++c) image.pixels[4 * i + c] = value;
    image.pixels[4 * i + 3] = static_cast<float>(4.0 * s * s);
  }
  return image;
}

TEST(RelativeNoiseRms, IsTheStandardDeviation) {
  const std::vector<bool> all(40000, true);
  EXPECT_NEAR(relative_noise_rms(noisy_image(0.05), all).value(), 0.05, 0.0005);
}

// One pixel in 400 has 40 times the light, by one sample of many: its standard error is its light.
// The root mean square of what it adds is 40 / sqrt(400) = 2 of the light; the median stays.
TEST(RelativeNoiseRms, SeesOutliersThatTheMedianHides) {
  Image image = noisy_image(0.05);
  const std::vector<bool> all(40000, true);
  const double median = relative_noise(image, all).value();
  for (int y = 10; y < 200; y += 20)
    for (int x = 10; x < 200; x += 20) {
      for (int c = 0; c < 3; ++c) image.at(x, y)[c] += 80.0f;
      image.at(x, y)[3] += 6400.0f;
    }
  EXPECT_NEAR(relative_noise(image, all).value(), median, 0.03 * median);
  const double inside = 198.0 * 198.0, fireflies = 100.0;
  const double wanted =
      40.0 * std::sqrt(fireflies / inside / 1.25);  // the neighbours see little of it
  EXPECT_NEAR(relative_noise_rms(image, all).value(), wanted, 0.02 * wanted);
}

// A step of a thousand standard errors is detail: columns 99 and 100 differ by at most three.
TEST(RelativeNoiseRms, LeavesOutWhatNoNoiseExplains) {
  Image image = noisy_image(0.01);
  for (int y = 0; y < 200; ++y)
    for (int x = 100; x < 200; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y)[c] *= 10.0f;
  const double noise = relative_noise_rms(image, std::vector<bool>(40000, true)).value();
  EXPECT_LT(noise, 0.011);
  EXPECT_FALSE(relative_noise_rms(noisy_image(0.0), std::vector<bool>(40000, true)));
  EXPECT_FALSE(relative_noise_rms(make_image(9, 9, {"Y"}), std::vector<bool>(81, true)));
}

}  // namespace
}  // namespace lamina
