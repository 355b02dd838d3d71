// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/resample.h"

#include <gtest/gtest.h>

#include <numeric>

namespace lamina {
namespace {

Image ramp(int width, int height) {
  Image image = make_image(width, height, {"Y"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at(x, y)[0] = (static_cast<float>(x) + 0.5f) / static_cast<float>(width);
  return image;
}

TEST(Resample, KeepsConstantsAndSlopes) {
  for (const int size : {16, 40, 100}) {
    Image constant = make_image(20, 20, {"A", "B"});
    for (float& value : constant.pixels) value = 0.25f;
    for (const float value : resampled(constant, size, 7).pixels) EXPECT_NEAR(value, 0.25f, 1e-6);
    const Image slope = resampled(ramp(20, 5), size, 5);
    for (int x = size / 4; x < size - size / 4; ++x)
      EXPECT_NEAR(slope.at(x, 2)[0], (x + 0.5) / size, size < 20 ? 3e-3 : 1e-5) << size;
  }
}

TEST(Resample, ShrinkingLosesNothing) {
  Image spots = make_image(64, 64, {"Y"});
  for (int y = 10; y < 60; y += 7)
    for (int x = 9; x < 60; x += 5) spots.at(x, y)[0] = 1.0f;
  const auto mean = [](const Image& image) {
    return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) /
           static_cast<double>(image.pixels.size());
  };
  EXPECT_NEAR(mean(resampled(spots, 16, 16)), mean(spots), 2e-3);
}

TEST(Resample, SameSizeIsTheSame) {
  const Image image = ramp(17, 9);
  EXPECT_EQ(resampled(image, 17, 9).pixels, image.pixels);
}

}  // namespace
}  // namespace lamina
