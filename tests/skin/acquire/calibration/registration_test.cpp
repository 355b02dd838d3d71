// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/registration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lamina/base/core/error.h"
#include "skin/acquire/calibration/synthetic_images.h"

namespace lamina {
namespace {

constexpr int width = 160, height = 120;

/// Where a moved image's place is in the other one.
Vec2 back(const ImageMotion& motion, Vec2 place) {
  const Vec2 middle{0.5 * width, 0.5 * height}, arm = place - middle - motion.shift;
  const double c = std::cos(motion.rotation) / motion.scale;
  const double s = std::sin(motion.rotation) / motion.scale;
  return middle + Vec2{c * arm.x + s * arm.y, c * arm.y - s * arm.x};
}

/// Skin in noise, moved. In a band of `negative` contrast spots are bright; `other` shows what
/// the first band does not.
Image skin_band(const ImageMotion& motion, std::uint64_t seed, double contrast = 0.1,
                double other = 0.0, double noise = 0.005) {
  Image image = image_of(width, height, {"Y"}, [&](double x, double y, std::size_t) {
    const Vec2 p = back(motion, {x, y});
    return 0.4 * skin_texture(p.x, p.y, contrast) * skin_texture(p.y + 900.0, -p.x, other);
  });
  add_noise(image, std::pow(0.4 * noise, 2), 0.0, seed);
  return image;
}

double corner_error(const ImageMotion& found, const ImageMotion& truth) {
  double largest = 0.0;
  for (const Vec2 corner : {Vec2{0, 0}, Vec2{width, 0}, Vec2{0, height}, Vec2{width, height}}) {
    const Vec2 d = moved(found, corner, width, height) - moved(truth, corner, width, height);
    largest = std::max(largest, std::hypot(d.x, d.y));
  }
  return largest;
}

TEST(Registration, FindsAShiftOfAThirdOfAPixel) {
  const ImageMotion truth{.shift = {0.3, -0.3}};
  const Registration found =
      register_images(skin_band({}, 1), 0, skin_band(truth, 2), 0, make_pixel_mask(width, height),
                      {.with_scale_and_rotation = false});
  EXPECT_NEAR(found.motion.shift.x, 0.3, 0.02);
  EXPECT_NEAR(found.motion.shift.y, -0.3, 0.02);
  EXPECT_TRUE(found.is_good);
  EXPECT_GT(found.agreement, 0.8);
}

TEST(Registration, FindsLateralColorAndLargeShifts) {
  for (const ImageMotion& truth :
       {ImageMotion{{0.3, 0.1}, 1.002, 0.001}, ImageMotion{{-6.4, 7.7}, 0.99, 0.02}}) {
    const Registration found = register_images(skin_band({}, 1), 0, skin_band(truth, 2), 0,
                                               make_pixel_mask(width, height));
    EXPECT_LT(corner_error(found.motion, truth), 0.05);
    EXPECT_TRUE(found.is_good);
  }
}

// As blood is bright where melanin is dark, and both have spots of their own.
TEST(Registration, FindsBandsOfOtherContrast) {
  const ImageMotion truth{{1.3, -0.6}, 1.001, -0.002};
  const Registration found =
      register_images(skin_band({}, 1, 0.1, 0.03), 0, skin_band(truth, 2, -0.05, 0.0), 0,
                      make_pixel_mask(width, height));
  EXPECT_LT(corner_error(found.motion, truth), 0.15);
  EXPECT_LT(corner_error(found.motion, truth), 3.0 * found.error);
  EXPECT_TRUE(found.is_good);
}

// Over seeds the errors are as large as expected, within a factor of 2.
TEST(Registration, KnowsItsError) {
  const ImageMotion truth{{0.4, 0.2}, 1.001, 0.001};
  double squares = 0.0, expected = 0.0;
  constexpr int count = 4;
  for (int seed = 0; seed < count; ++seed) {
    const auto s = static_cast<std::uint64_t>(2 * seed);
    const Registration found =
        register_images(skin_band({}, s, 0.1, 0.0, 0.02), 0,
                        skin_band(truth, s + 1, 0.1, 0.0, 0.02), 0, make_pixel_mask(width, height));
    squares += std::pow(corner_error(found.motion, truth), 2) / count;
    expected += found.error * found.error / count;
  }
  EXPECT_LT(std::sqrt(squares), 2.0 * std::sqrt(expected));
  EXPECT_GT(std::sqrt(squares), 0.5 * std::sqrt(expected));
}

TEST(Registration, RefusesImagesOfOtherThings) {
  const Image skin = skin_band({}, 1);
  Image other = image_of(width, height, {"Y"}, [](double x, double y, std::size_t) {
    return 0.4 * skin_texture(1.3 * y + 500.0, 0.7 * x, 0.1);
  });
  add_noise(other, 4e-6, 0.0, 3);
  Image noise = make_image(width, height, {"Y"});
  add_noise(noise, 1e-4, 0.0, 4);
  const PixelMask all = make_pixel_mask(width, height);
  const Image stripes = image_of(width, height, {"Y"}, [](double x, double, std::size_t) {
    return 0.4 + 0.1 * std::sin(0.5 * x);
  });
  EXPECT_FALSE(register_images(stripes, 0, stripes, 0, all).is_good);  // of no known height
  for (const Image& image : {other, noise, make_image(width, height, {"Y"})}) {
    const Registration found = register_images(skin, 0, image, 0, all);
    EXPECT_FALSE(found.is_good) << found.error << " " << found.agreement;
    EXPECT_THROW(require_registered(found, "the band 640nm"), InvalidInput);
  }
  EXPECT_THROW((void)register_images(skin, 0, make_image(9, 9, {"Y"}), 0, all), InvalidInput);
  EXPECT_THROW((void)register_images(skin, 0, skin, 0, make_pixel_mask(9, 9)), InvalidInput);
  EXPECT_THROW((void)register_channels(skin, 1, all), InvalidInput);
  PixelMask none = all;
  for (auto& fault : none.faults) fault = 1;
  EXPECT_THROW((void)register_images(skin, 0, skin, 0, none), InvalidInput);
}

// Dust on the sensor stays where it is; what is masked does not count.
TEST(Registration, LeavesOutWhatIsMasked) {
  const ImageMotion truth{.shift = {2.3, -1.7}};
  Image fixed = skin_band({}, 1), moving = skin_band(truth, 2);
  PixelMask mask = make_pixel_mask(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if ((x / 4 + y / 4) % 12 == 0) {
        const float dust = x % 4 == 0 ? std::numeric_limits<float>::quiet_NaN() : 3.0f;
        fixed.at(x, y)[0] = moving.at(x, y)[0] = dust;
        mask.mark(mask.index(x, y), PixelFault::saturated);
      }
  const Registration found = register_images(fixed, 0, moving, 0, mask);
  EXPECT_LT(corner_error(found.motion, truth), 0.1);
  EXPECT_TRUE(found.is_good);
}

TEST(MovedBack, ShowsEachChannelWhereTheFirstIs) {
  const ImageMotion motion{{1.3, -0.4}, 1.002, 0.003};
  const auto scene = [&](double x, double y, std::size_t c) {
    const Vec2 p = c == 0 ? Vec2{x, y} : back(motion, {x, y});
    return 0.4 * skin_texture(0.3 * p.x, 0.3 * p.y, 0.1);
  };
  Developed image{.reflectance = image_of(width, height, {"a", "b"}, scene),
                  .deviation = image_of(width, height, {"a", "b"},
                                        [](double, double, std::size_t) { return 0.01; }),
                  .mask = make_pixel_mask(width, height)};
  image.mask.mark(image.mask.index(80, 60), PixelFault::specular);
  const Developed still = moved_back(image, std::vector<ImageMotion>{{}, motion});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!still.mask.is_used(x, y)) continue;
      ASSERT_NEAR(still.reflectance.at(x, y)[1], still.reflectance.at(x, y)[0], 5e-4);
      ASSERT_NEAR(still.deviation.at(x, y)[1], 0.01, 1e-7);
    }
  const MaskCounts counts = count_pixels(still.mask);
  EXPECT_GE(counts.faults[4], 5u);  // the highlight, wherever it is seen
  EXPECT_LE(counts.faults[4], 17u);
  EXPECT_NEAR(static_cast<double>(counts.faults[6]), 3.0 * height + 2.0 * width, 300.0);
  const Developed same = moved_back(image, std::vector<ImageMotion>(2));
  EXPECT_EQ(same.reflectance.pixels[1], image.reflectance.pixels[1]);
  EXPECT_THROW((void)moved_back(image, std::vector<ImageMotion>(1)), InvalidInput);
}

}  // namespace
}  // namespace lamina
