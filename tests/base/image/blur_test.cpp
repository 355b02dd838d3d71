// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/blur.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lamina {
namespace {

/// Mean and variance along x of what a bright column becomes [texel].
struct Moments {
  double sum = 0.0, variance = 0.0;
};
Moments moments_of(const Image& image, double middle) {
  Moments moments;
  for (int x = 0; x < image.width; ++x) {
    const auto light = static_cast<double>(*image.at(x, image.height / 2));
    moments.sum += light;
    moments.variance += light * (x - middle) * (x - middle);
  }
  moments.variance /= moments.sum;
  return moments;
}

// Narrow ones on the grid, wide ones on a coarser one: the same law for both.
TEST(Blur, HasTheVarianceThatIsAskedForAndKeepsTheSum) {
  for (const double spread : {1.5, 5.0, 8.0, 15.0, 24.0}) {
    Image image = make_image(239, 8, {"Y"});
    for (int y = 0; y < 8; ++y) *image.at(119, y) = 1.0f;
    const Moments moments = moments_of(blurred(image, spread), 119.0);
    EXPECT_NEAR(moments.sum, 1.0, 0.02) << spread;  // of one column, which coarse texels split
    EXPECT_NEAR(std::sqrt(moments.variance), spread, 0.04 * spread) << spread;
  }
}

TEST(Blur, LeavesAConstantAndDoesNotMixChannels) {
  Image image = make_image(50, 30, {"A", "B"});
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = i % 2 ? 3.0f : 0.25f;
  for (const double spread : {0.0, 2.0, 20.0, 500.0}) {
    const Image result = blurred(image, spread);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      ASSERT_NEAR(result.pixels[i], image.pixels[i], 1e-5) << spread;
  }
}

}  // namespace
}  // namespace lamina
