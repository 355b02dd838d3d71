// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lamina/base/core/error.h"
#include "skin/acquire/calibration/synthetic_images.h"

namespace lamina {
namespace {

constexpr double read = 1e-6, gain = 1e-5, black = 0.05;

/// Skin in light that falls off, half of it with hair.
Image skin_in_noise(std::uint64_t seed) {
  Image image = image_of(320, 240, {"Y"}, [](double x, double y, std::size_t) {
    const double hair = y < 120.0 ? 1.0 + 0.2 * std::sin(2.0 * x + 3.0 * y) : 1.0;
    return (0.1 + 0.6 * x / 320.0) * skin_texture(x, y, 0.02) * hair;
  });
  add_noise(image, read, gain, seed);
  for (float& v : image.pixels) v += static_cast<float>(black);
  return image;
}

TEST(Noise, IsFoundFromOneImage) {
  const SensorNoise noise = estimate_noise(skin_in_noise(1), make_pixel_mask(320, 240), {black})[0];
  for (const double light : {0.1, 0.3, 0.6})
    EXPECT_NEAR(std::sqrt(noise.variance(black + light)), std::sqrt(read + gain * light),
                0.1 * std::sqrt(read + gain * light))
        << light;
}

// Whatever the scene, also in the hair.
TEST(Noise, IsFoundFromTwoImages) {
  PixelMask mask = make_pixel_mask(320, 240);
  for (int y = 120; y < 240; ++y)
    for (int x = 0; x < 320; ++x) mask.mark(mask.index(x, y), PixelFault::excluded);
  const SensorNoise noise = estimate_noise(skin_in_noise(1), skin_in_noise(2), mask, {black})[0];
  for (const double light : {0.1, 0.3, 0.6})
    EXPECT_NEAR(std::sqrt(noise.variance(black + light)), std::sqrt(read + gain * light),
                0.1 * std::sqrt(read + gain * light))
        << light;
}

TEST(Noise, OfNoneIsNone) {
  const Image image =
      image_of(64, 64, {"Y"}, [](double x, double, std::size_t) { return 0.25 * x; });
  const SensorNoise noise = estimate_noise(image, make_pixel_mask(64, 64))[0];
  EXPECT_NEAR(noise.variance(10.0), 0.0, 1e-10);
}

TEST(Noise, NeedsSomePixels) {
  PixelMask mask = make_pixel_mask(320, 240);
  for (std::size_t i = 0; i < mask.faults.size(); i += 8) mask.mark(i, PixelFault::saturated);
  EXPECT_THROW((void)estimate_noise(skin_in_noise(1), mask), InvalidInput);
  EXPECT_THROW((void)estimate_noise(skin_in_noise(1), make_pixel_mask(3, 3)), InvalidInput);
  EXPECT_THROW((void)estimate_noise(skin_in_noise(1), make_pixel_mask(320, 240), {1.0, 2.0}),
               InvalidInput);
  EXPECT_THROW((void)estimate_noise(skin_in_noise(1), make_image(320, 240, {"R"}),
                                    make_pixel_mask(320, 240)),
               InvalidInput);
}

TEST(PixelMask, LeavesOutTheEdgeOfTheTape) {
  PixelMask mask = make_pixel_mask(9, 7);
  mask.mark(mask.index(2, 3), PixelFault::excluded);
  mask.mark(mask.index(8, 6), PixelFault::saturated);  // no tape
  const PixelMask wide = eroded(mask, 2);
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 9; ++x) {
      const bool is_near = std::abs(x - 2) <= 2 && std::abs(y - 3) <= 2;
      EXPECT_EQ(wide.is_used(x, y), !is_near && !(x == 8 && y == 6)) << x << " " << y;
    }
  EXPECT_EQ(counts_text(count_pixels(wide)), "37 pixels used; 1 excluded, 24 edge, 1 saturated");
  EXPECT_EQ(eroded(mask, 0).faults, mask.faults);
  EXPECT_THROW(require_used_pixels(eroded(mask, 9), "mask.png"), InvalidInput);
  EXPECT_THROW((void)eroded(mask, -1), InvalidInput);
  EXPECT_THROW((void)combined(mask, make_pixel_mask(7, 9)), InvalidInput);
  Image painted = make_image(9, 7, {"Y"});
  painted.at(4, 4)[0] = 1.0f;
  EXPECT_EQ(count_pixels(combined(mask, mask_from_image(painted))).used, 1u);
}

}  // namespace
}  // namespace lamina
