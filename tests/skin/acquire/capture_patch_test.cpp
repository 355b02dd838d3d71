// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/capture_patch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

/// Two bands with noise of their own under a window and under strips, mirrored light included.
Capture made_capture() {
  constexpr int width = 13, height = 9;
  Capture capture;
  capture.wavelengths = {450.0, 580.0};
  capture.sensor = DenseMatrix(2, 2);
  capture.sensor(0, 0) = capture.sensor(1, 1) = 1.0;
  capture.errors = {0.01, 0.02};
  capture.incidence = {.theta = 0.5};
  capture.has_specular = true;
  capture.mm_per_pixel = 0.25;
  capture.population = forearm_population();
  const std::vector<SkinFitNumber> all = skin_fit_numbers({});
  capture.numbers = {all[0], all[3]};
  capture.reflectance = make_image(width, height, {"450nm", "580nm"});
  capture.deviation = capture.reflectance;
  capture.lights = {make_image(width, height, {"Y"}), make_image(width, height, {"Y"})};
  capture.band_lights = {0, 1};
  capture.mask = make_pixel_mask(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      *capture.lights[0].at(x, y) = x < 2 ? 0.0f : 1.0f;
      *capture.lights[1].at(x, y) = x < 2 ? 0.0f : 0.6f + 0.4f * static_cast<float>(y % 3);
      const auto wave = static_cast<float>(std::sin(x + 2.0 * y));
      capture.reflectance.at(x, y)[0] = 0.22f + 0.02f * wave;
      capture.reflectance.at(x, y)[1] = 0.36f - 0.02f * wave;
      capture.deviation.at(x, y)[0] = 0.001f + 0.002f * static_cast<float>(x % 2);
    }
  capture.mask.mark(capture.mask.index(7, 4), PixelFault::saturated);
  return capture;
}

TEST(CapturePatch, OfARectangleIsThePartOfTheWhole) {
  const Capture capture = made_capture();
  const LargePatch patch = patch_of(capture);
  ASSERT_EQ(patch.width, 13);
  const PatchCapture whole = patch.part({0, 0, 13, 9});
  const TexelRectangle place{4, 3, 6, 5};
  const PatchCapture part = patch.part(place), expected = part_of(whole, place);
  EXPECT_EQ(part.width, 6);
  EXPECT_EQ(part.height, 5);
  EXPECT_EQ(part.mm_per_texel, 0.25);
  EXPECT_EQ(part.theta, expected.theta);
  ASSERT_EQ(part.lights.size(), 2U);
  ASSERT_EQ(part.images.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(part.lights[i].values, expected.lights[i].values);
    EXPECT_EQ(part.images[i].reflected.values, expected.images[i].reflected.values);
    EXPECT_EQ(part.images[i].deviation.values, expected.images[i].deviation.values);
    EXPECT_EQ(part.images[i].sensor, expected.images[i].sensor);
    EXPECT_EQ(part.images[i].light, i);
  }
  // By hand: texel (3, 1) is the saturated pixel (7, 4); beside it the larger of both errors
  // counts.
  EXPECT_TRUE(std::isinf(part.images[0].deviation.values[6 + 3]));
  EXPECT_FLOAT_EQ(part.images[0].deviation.values[0], 0.01f * capture.reflectance.at(4, 3)[0]);
  EXPECT_FLOAT_EQ(part.images[0].deviation.values[1], 0.003f);
  const float mirrored =
      (capture.reflectance.at(5, 5)[1] - part.images[1].reflected.values[6 * 2 + 1]) /
      *capture.lights[1].at(5, 5);
  EXPECT_GT(mirrored, 0.02f);
  EXPECT_LT(mirrored, 0.05f);
}

TEST(CapturePatch, SamplesPixelsThatAreUsedAndLit) {
  Capture capture = made_capture();
  EXPECT_EQ(sampled_patch(capture, 1000).width, 11 * 9 - 1);
  const PatchCapture sampled = sampled_patch(capture, 30);
  EXPECT_EQ(sampled.width, 25);  // every fourth
  EXPECT_EQ(sampled.height, 1);
  const PatchCapture whole = patch_of(capture).part({0, 0, 13, 9});
  EXPECT_EQ(sampled.images[1].reflected.values[0], whole.images[1].reflected.values[2]);
  EXPECT_EQ(sampled.images[1].reflected.values[1], whole.images[1].reflected.values[6]);
  for (Image& light : capture.lights) light.pixels.assign(light.pixels.size(), 0.0f);
  EXPECT_THROW((void)sampled_patch(capture, 30), InvalidInput);
}

// Where light does not travel tiles need no halo, and have the very maps of the whole.
TEST(CapturePatch, InTilesHasTheMapsOfTheWhole) {
  Capture capture = made_capture();
  const InversionModel model{.numbers = {"melanin", "hemoglobin_dermis"},
                             .population = capture.population,
                             .has_transport = false};
  InversionOptions options{.is_by_texel = true, .deviation_samples = 1};
  const InversionTables tables = make_inversion_tables(sampled_patch(capture, 30), model);
  options.error_growth =
      error_growth_of(misfit_of_texels(sampled_patch(capture, 30), tables, options));
  for (int x = 9; x < 13; ++x)
    for (int y = 0; y < 5; ++y) capture.mask.mark(capture.mask.index(x, y), PixelFault::excluded);
  const LargePatch patch = patch_of(capture);
  const InversionResult whole = invert_patch(patch.part({0, 0, 13, 9}), tables, options);
  InversionResult placed;
  int tiles = 0, without_errors = 0;
  const InversionResult course =
      invert_tiles(patch, tables, {.side = 5, .halo = 0.0}, options,
                   [&](const PatchTile& tile, const InversionResult& part) {
                     put_tile(13, 9, tile, part, placed);
                     ++tiles;
                     without_errors += part.numbers[0].deviation.values.empty() ? 1 : 0;
                   });
  EXPECT_EQ(tiles, 6);
  EXPECT_EQ(without_errors, 1);  // of which nothing is known
  EXPECT_TRUE(course.numbers.empty());
  EXPECT_FALSE(course.history.empty());
  for (std::size_t n = 0; n < 2; ++n)
    for (int y = 0; y < 9; ++y)
      for (int x = 2; x < 13; ++x) {
        const std::size_t t = capture.mask.index(x, y);
        if (capture.mask.faults[t] != 0) continue;
        EXPECT_EQ(placed.numbers[n].value.values[t], whole.numbers[n].value.values[t]);
        EXPECT_EQ(placed.numbers[n].deviation.values[t], whole.numbers[n].deviation.values[t]);
        EXPECT_EQ(placed.residual[n].values[t], whole.residual[n].values[t]);
      }
}

}  // namespace
}  // namespace lamina
