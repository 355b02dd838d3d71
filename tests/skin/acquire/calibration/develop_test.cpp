// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/develop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lamina/base/core/error.h"
#include "lamina/skin/acquire/calibration/gray_card.h"
#include "lamina/skin/acquire/calibration/polarized_pair.h"
#include "skin/acquire/calibration/synthetic_images.h"

namespace lamina {
namespace {

const std::vector<std::string> bands = {"480nm", "580nm"};

/// A camera with vignetting, a pattern in the dark, gains per band, and exposures.
struct SyntheticCamera {
  int width = 96, height = 64;
  double read_variance = 0.0, gain = 0.0;

  double dark(double x, double y) const { return 0.02 + 0.005 * std::sin(x + 3.0 * y); }
  double light(double x, double y, std::size_t band) const {
    const double r2 = std::pow(x / width - 0.5, 2) + std::pow(y / height - 0.5, 2);
    return (band == 0 ? 0.6 : 0.8) * (1.0 - 0.8 * r2);
  }
  double reflectance(double x, double y, std::size_t band) const {
    return (band == 0 ? 0.25 : 0.4) * skin_texture(0.3 * x, 0.3 * y, 0.1);
  }
  template <class Scene>
  Image photograph(double exposure, std::uint64_t seed, const Scene& scene) const {
    Image image = image_of(width, height, bands, [&](double x, double y, std::size_t b) {
      return exposure * light(x, y, b) * scene(x, y, b);
    });
    add_noise(image, read_variance, gain, seed);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (std::size_t b = 0; b < 2; ++b)
          image.at(x, y)[b] += static_cast<float>(dark(x + 0.5, y + 0.5));
    return image;
  }
  Photographs photographs(double exposure_of_white, std::uint64_t seed) const {
    const auto skin = [&](double x, double y, std::size_t b) { return reflectance(x, y, b); };
    const auto white = [&](double, double, std::size_t b) { return b == 0 ? 0.9 : 0.95; };
    const auto nothing = [](double, double, std::size_t) { return 0.0; };
    return {.raw = photograph(1.0, seed, skin),
            .white = photograph(exposure_of_white, seed + 1, white),
            .dark = photograph(1.0, seed + 2, nothing)};
  }
};

TEST(Develop, InvertsACameraExactly) {
  const SyntheticCamera camera;
  const Developed image = develop(
      camera.photographs(0.5, 1), make_pixel_mask(96, 64),
      {.white_reflectance = {0.9, 0.95}, .exposure_ratio = {0.5}, .noise = {{1e-6}, {1e-6}}});
  EXPECT_EQ(count_pixels(image.mask).used, 96u * 64u);
  EXPECT_EQ(image.reflectance.channels, bands);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x)
      for (std::size_t b = 0; b < 2; ++b)
        ASSERT_NEAR(image.reflectance.at(x, y)[b], camera.reflectance(x + 0.5, y + 0.5, b), 2e-6);
}

// Errors over their standard deviations have one of 1, in bright and in dark corners.
TEST(Develop, KnowsItsErrors) {
  const SyntheticCamera camera{.read_variance = 4e-6, .gain = 2e-5};
  const DevelopOptions options{.white_reflectance = {0.9, 0.95},
                               .noise = {{4e-6, 2e-5, 0.02}, {4e-6, 2e-5, 0.02}}};
  const Developed image = develop(camera.photographs(1.0, 5), make_pixel_mask(96, 64), options);
  double squares = 0.0;
  int count = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x, ++count) {
      const double error = static_cast<double>(image.reflectance.at(x, y)[1]) -
                           camera.reflectance(x + 0.5, y + 0.5, 1);
      squares += std::pow(error / static_cast<double>(image.deviation.at(x, y)[1]), 2);
    }
  EXPECT_NEAR(std::sqrt(squares / count), 1.0, 0.04);
  // Found from the image alone the noise is that, too.
  const Developed found = develop(camera.photographs(1.0, 5), make_pixel_mask(96, 64),
                                  {.white_reflectance = {0.9, 0.95}});
  EXPECT_NEAR(found.deviation.at(48, 32)[1], image.deviation.at(48, 32)[1],
              0.1 * static_cast<double>(image.deviation.at(48, 32)[1]));
}

TEST(Develop, LeavesOutWhatCannotBeUsed) {
  const SyntheticCamera camera;
  Photographs photographs = camera.photographs(1.0, 1);
  photographs.raw.at(3, 4)[0] = 1.0f;
  photographs.raw.at(5, 6)[1] = std::numeric_limits<float>::quiet_NaN();
  photographs.white.at(7, 8)[1] = 0.03f;
  photographs.raw.at(9, 10)[0] = 0.0f;
  PixelMask mask = make_pixel_mask(96, 64);
  mask.mark(0, PixelFault::excluded);
  const DevelopOptions options{.noise = {{1e-6}, {1e-6}}};
  const Developed image = develop(photographs, mask, options);
  EXPECT_EQ(counts_text(count_pixels(image.mask)),
            "6140 pixels used; 1 excluded, 1 not finite, 1 saturated, 1 dark white");
  EXPECT_EQ(image.negative, (std::vector<std::size_t>{1, 0}));
  EXPECT_EQ(image.far_negative, (std::vector<std::size_t>{1, 0}));
  EXPECT_EQ(image.reflectance.at(3, 4)[0], 0.0f);
  EXPECT_FLOAT_EQ(static_cast<float>(image.saturation), 0.98f);

  for (auto& fault : mask.faults) fault = 1;
  EXPECT_THROW((void)develop(photographs, mask, options), InvalidInput);
  const PixelMask all = make_pixel_mask(96, 64);
  EXPECT_THROW((void)develop(photographs, make_pixel_mask(96, 65), options), InvalidInput);
  EXPECT_THROW((void)develop(photographs, all, {.white_reflectance = {99.0}}), InvalidInput);
  EXPECT_THROW((void)develop(photographs, all, {.exposure_ratio = {1.0, 0.0}}), InvalidInput);
  EXPECT_THROW((void)develop(photographs, all, {.exposure_ratio = {1.0, 1.0, 1.0}}), InvalidInput);
  EXPECT_THROW((void)develop(photographs, all, {.saturation = 0.0, .darkest_white = 2.0}),
               InvalidInput);
  Photographs other = photographs;
  other.white = make_image(96, 64, {"480nm", "600nm"});
  EXPECT_THROW((void)develop(other, all, options), InvalidInput);
  other = photographs;
  other.dark = photographs.white;  // brighter than all: nothing is left
  EXPECT_THROW((void)develop(other, all, options), InvalidInput);
}

TEST(Saturation, IsFoundWhereNumbersPileUp) {
  const auto clipped_at = [](double top) {
    Image image = image_of(40, 40, {"Y"},
                           [](double x, double y, std::size_t) { return 0.02 * x + 0.001 * y; });
    for (float& v : image.pixels) v = std::min(v, static_cast<float>(top));
    return image;
  };
  EXPECT_NEAR(find_saturation(clipped_at(0.5)), 0.98 * 0.5, 1e-6);  // 15 of 16 bits, say
  EXPECT_TRUE(std::isinf(find_saturation(clipped_at(0.9))));
  const Image even = image_of(40, 40, {"Y"}, [](double, double, std::size_t) { return 0.9; });
  EXPECT_TRUE(std::isinf(find_saturation(even)));
}

TEST(Specular, IsWhatExceedsAllBandsAlike) {
  const auto skin = [](double x, double y, std::size_t b) {
    const double base = (b == 0 ? 0.25 : 0.4) * skin_texture(0.2 * x, 0.2 * y, 0.05);
    if (x > 40.0 && x < 44.0 && y > 30.0 && y < 34.0) return base + 0.1;  // mirrors
    if (x > 70.0 && x < 74.0 && y > 30.0 && y < 34.0)
      return base + (b == 0 ? 0.0 : 0.1);  // reddish
    return base;
  };
  Developed image{
      .reflectance = image_of(100, 64, bands, skin),
      .deviation = image_of(100, 64, bands, [](double, double, std::size_t) { return 0.004; }),
      .mask = make_pixel_mask(100, 64)};
  mark_specular(image);
  EXPECT_EQ(count_pixels(image.mask).faults[4], 16u);
  EXPECT_FALSE(image.mask.is_used(41, 31));
  EXPECT_THROW(mark_specular(image, {.least_excess = 0.0}), InvalidInput);
}

TEST(PolarizedPair, TellsTheSurfaceFromBelow) {
  constexpr double leak = 0.01;
  const auto diffuse = [](double x, double, std::size_t b) {
    return (b == 0 ? 0.3 : 0.4) + 0.001 * x;
  };
  const auto specular = [](double, double y, std::size_t) { return 0.02 + 0.0005 * y; };
  const auto developed = [&](double share, double deviation, std::uint64_t seed) {
    Developed image{.reflectance = image_of(64, 64, bands,
                                            [&](double x, double y, std::size_t b) {
                                              return 0.5 * diffuse(x, y, b) +
                                                     share * specular(x, y, b);
                                            }),
                    .mask = make_pixel_mask(64, 64)};
    image.deviation =
        image_of(64, 64, bands, [&](double, double, std::size_t) { return deviation; });
    add_noise(image.reflectance, deviation * deviation, 0.0, seed);
    return image;
  };
  Developed parallel = developed(1.0 - leak, 0.002, 1);
  const Developed crossed = developed(leak, 0.001, 2);
  parallel.mask.mark(7, PixelFault::saturated);
  const PolarizedPair pair = separate_polarized(parallel, crossed, {.leak = leak});
  double squares = 0.0, mirrored = 0.0;
  for (int y = 1; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const double d =
          static_cast<double>(pair.diffuse.reflectance.at(x, y)[1]) - diffuse(x + 0.5, y, 1);
      const double s = static_cast<double>(pair.specular.at(x, y)[0]) - specular(x, y + 0.5, 0);
      squares +=
          std::pow(d / static_cast<double>(pair.diffuse.deviation.at(x, y)[1]), 2) / (63 * 64);
      mirrored +=
          std::pow(s / static_cast<double>(pair.specular_deviation.at(x, y)[0]), 2) / (63 * 64);
    }
  EXPECT_NEAR(std::sqrt(squares), 1.0, 0.04);
  EXPECT_NEAR(std::sqrt(mirrored), 1.0, 0.04);
  EXPECT_FALSE(pair.diffuse.mask.is_used(7, 0));
  EXPECT_THROW((void)separate_polarized(parallel, crossed, {.leak = 0.5}), InvalidInput);
}

TEST(GrayCard, TracksTheExposure) {
  const auto card = [](double exposure, std::uint64_t seed) {
    Image image = image_of(40, 30, {"R", "G", "B"}, [&](double x, double, std::size_t c) {
      return exposure * (x < 20.0 ? 0.18 : 0.02) * (1.0 + 0.2 * static_cast<double>(c));
    });
    add_noise(image, 1e-6, 0.0, seed);
    return image;
  };
  PixelMask left = make_pixel_mask(40, 30);
  for (int y = 0; y < 30; ++y)
    for (int x = 18; x < 40; ++x) left.mark(left.index(x, y), PixelFault::excluded);
  const CardReading first = read_card(card(1.0, 1), left, 1.0, "first.tif");
  const CardReading second = read_card(card(1.7, 2), left, 1.0, "second.tif");
  const ExposureRatio ratio = exposure_ratio(first, second);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(ratio.factor[c], 1.7, 3.0 * 1.7 * ratio.deviation[c]);
    EXPECT_LT(ratio.deviation[c], 0.003);
  }
  EXPECT_NEAR(white_level(first, {0.18})[1], 1.2, 0.01);

  const auto refuses = [&](const Image& image, const PixelMask& mask, double saturation) {
    EXPECT_THROW((void)read_card(image, mask, saturation, "a.tif"), InvalidInput);
  };
  refuses(card(1.0, 1), make_pixel_mask(40, 30), 1.0);  // not uniform
  refuses(card(1.0, 1), left, 0.15);                    // saturated
  refuses(card(-1.0, 1), left, 1.0);
  refuses(card(1.0, 1), make_pixel_mask(4, 3), 1.0);
  EXPECT_THROW((void)white_level(first, {18.0}), InvalidInput);
}

}  // namespace
}  // namespace lamina
