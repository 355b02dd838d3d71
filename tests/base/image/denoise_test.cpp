// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/denoise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"

namespace lamina {
namespace {

constexpr int width = 64, height = 48;
constexpr float sigma = 0.1f;

/// What the picture shows without noise: a ramp, and a fourfold brighter surface of another albedo
/// on the right.
float truth(int x, int y) {
  return (x < 40 ? 1.0f : 4.0f) * (1.0f + 0.004f * static_cast<float>(y));
}

Image noisy_image(float noise, std::uint64_t seed) {
  Image image = make_image(width, height,
                           {"R", "G", "B", "variance", "albedo.R", "albedo.G", "albedo.B", "note"});
  Random random = make_random(seed, 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float* p = image.at(x, y);
      const float at_most = noise * std::sqrt(3.0f);  // uniform, with that standard deviation
      const float value = truth(x, y) + at_most * (2.0f * random.uniform_float() - 1.0f);
      p[0] = p[1] = p[2] = value;
      p[3] = noise * noise;
      p[4] = p[5] = p[6] = x < 40 ? 0.2f : 0.8f;
      p[7] = static_cast<float>(x);
    }
  return image;
}

double rms_error(const Image& image) {
  double sum = 0.0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      sum += std::pow(static_cast<double>(image.at(x, y)[0] - truth(x, y)), 2);
  return std::sqrt(sum / (width * height));
}

TEST(Denoise, TakesMostOfTheNoiseAndKeepsTheEdge) {
  const Image noisy = noisy_image(sigma, 1);
  const Image clean = denoise(noisy);
  EXPECT_NEAR(rms_error(noisy), 0.1, 0.005);
  EXPECT_LT(rms_error(clean), 0.03);
  double bias = 0.0, edge = 0.0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      bias += static_cast<double>(clean.at(x, y)[0] - truth(x, y)) / (width * height);
    edge = std::max(edge, std::abs(static_cast<double>(clean.at(39, y)[0] - truth(39, y))));
  }
  EXPECT_LT(std::abs(bias), 0.005);
  EXPECT_LT(edge, 0.15);  // a leak of the other side would be 3
}

TEST(Denoise, LeavesWhatHasNoNoise) { EXPECT_LT(rms_error(denoise(noisy_image(0.0f, 1))), 1e-5); }

TEST(Denoise, KeepsAllOtherChannelsAndTheNoisyColors) {
  const Image noisy = noisy_image(sigma, 2);
  const Image clean = denoise(noisy);
  ASSERT_EQ(clean.channel_count(), noisy.channel_count() + 3);
  const std::size_t before = channel_index(clean, "noisy.R").value();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      EXPECT_EQ(clean.at(x, y)[before], noisy.at(x, y)[0]);
      EXPECT_EQ(clean.at(x, y)[7], noisy.at(x, y)[7]);
    }
}

TEST(Denoise, WorksOnImagesSmallerThanItsWindowAndWithoutFeatures) {
  Image image = make_image(3, 2, {"R", "G", "B", "variance"});
  for (float& value : image.pixels) value = 0.5f;
  const Image clean = denoise(image);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) EXPECT_NEAR(clean.at(x, y)[1], 0.5f, 1e-6f);
}

/// One sample of 64 brings 6400 to pixel (20, 20): its mean is then 100 above the others, and so is
/// its standard error.
Image with_firefly(Image image, int x, int y, float red = 1.0f) {
  float* p = image.at(x, y);
  const float light[] = {100.0f * red, 100.0f, 100.0f};
  for (int c = 0; c < 3; ++c) p[c] += light[c];
  p[3] += 1e4f;
  return image;
}

// The filter without the firefly is the witness: what it adds to the picture, and how far from it.
TEST(Denoise, FireflyIsCutBeforeItsLightIsSpread) {
  const Image noisy = noisy_image(sigma, 3);
  const Image wanted = denoise(noisy);
  Image with = with_firefly(with_firefly(noisy, 20, 20, 0.1f), 21, 21);
  const Image clean = denoise(with);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(clean.at(x, y)[c], wanted.at(x, y)[c], 0.06f) << x << ' ' << y;
  const std::size_t before = channel_index(clean, "noisy.R").value();
  EXPECT_EQ(clean.at(20, 20)[before], with.at(20, 20)[0]);  // nothing is lost
}

// A lamp that fills a pixel: as bright, but all samples see it.
TEST(Denoise, SmallBrightThingThatAllSamplesSeeStays) {
  Image image = noisy_image(sigma, 4);
  for (int c = 0; c < 3; ++c) image.at(20, 20)[c] = 100.0f;
  image.at(20, 20)[3] = 1.0f;
  EXPECT_NEAR(denoise(image).at(20, 20)[1], 100.0f, 1.0f);
}

// One sample of 16 in every fourth pixel brings all the light of a picture: its mean stays.
TEST(Denoise, LightThatFewSamplesFindStays) {
  Image image = noisy_image(sigma, 5);
  double before = 0.0, after = 0.0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool is_found = (7 * x + 11 * y) % 16 < 4;
      for (int c = 0; c < 3; ++c) image.at(x, y)[c] = is_found ? 4.0f : 0.0f;
      image.at(x, y)[3] = is_found ? 16.0f : 0.0f;
      before += static_cast<double>(image.at(x, y)[1]);
    }
  const Image clean = denoise(image);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) after += static_cast<double>(clean.at(x, y)[1]);
  EXPECT_NEAR(after, before, 0.1 * before);
}

TEST(Denoise, NeedsColorsAndVariance) {
  EXPECT_THROW((void)denoise(make_image(2, 2, {"R", "G", "B"})), InvalidInput);
  EXPECT_THROW((void)denoise(make_image(2, 2, {"Y", "variance"})), InvalidInput);
}

}  // namespace
}  // namespace lamina
