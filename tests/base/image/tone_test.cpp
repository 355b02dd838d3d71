// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/tone.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

TEST(Filmic, CurveKeepsMidGreyAndItsContrast) {
  EXPECT_EQ(filmic_curve(0.0), 0.0);
  EXPECT_NEAR(filmic_curve(0.18), 0.18, 1e-15);
  const double stops = std::log2(filmic_curve(0.18 * 1.001) / 0.18) / std::log2(1.001);
  EXPECT_NEAR(stops, 0.98, 0.01);
  EXPECT_NEAR(filmic_curve(16.0 * (1.0 - 1e-12)), 1.0, 1e-12);
  EXPECT_EQ(filmic_curve(1e30), 1.0);
  EXPECT_EQ(filmic_curve(std::numeric_limits<double>::infinity()), 1.0);
  EXPECT_EQ(filmic_curve(std::nan("")), 0.0);
  EXPECT_EQ(filmic_curve(-1.0), 0.0);
}

TEST(Filmic, CurveRises) {
  double before = -1.0;
  for (double light = 0.0; light < 16.0; light += 0.01) {
    EXPECT_GT(filmic_curve(light), before);
    before = filmic_curve(light);
  }
}

LinearSrgb any_light() {
  LinearSrgb light{};
  for (double& channel : light) channel = std::exp(*rc::gen::inRange(-7000, 4000) / 1000.0);
  return light;
}

double hue(const LinearSrgb& color) {  // place of the middle channel between the others
  LinearSrgb sorted = color;
  std::ranges::sort(sorted);
  return (sorted[1] - sorted[0]) / (sorted[2] - sorted[0]);
}

RC_GTEST_PROP(Filmic, KeepsHueAndOrder, ()) {
  const LinearSrgb light = any_light();
  const LinearSrgb shown = filmic(light);
  for (std::size_t c = 0; c < 3; ++c) {
    RC_ASSERT(shown[c] >= 0.0 && shown[c] <= 1.0);
    for (std::size_t d = 0; d < 3; ++d)
      if (light[c] < light[d]) RC_ASSERT(shown[c] <= shown[d]);
  }
  const auto [low, high] = std::ranges::minmax(shown);
  if (high - low > 1e-6) RC_ASSERT(std::abs(hue(shown) - hue(light)) < 1e-6);
}

RC_GTEST_PROP(Filmic, GreyStaysGreyAndHighlightsLoseSaturation, ()) {
  const double grey = any_light()[0];
  const LinearSrgb shown = filmic({grey, grey, grey});
  RC_ASSERT(shown[0] == shown[1] && shown[1] == shown[2]);
  const LinearSrgb bright = filmic({4.0 * (1.0 + grey), 3.0 * (1.0 + grey), 2.0 * (1.0 + grey)});
  RC_ASSERT(bright[2] / bright[0] > 0.5);
}

// A polynomial of the sixth degree that was fitted to the curve: [Wrensch2023].
TEST(AgX, CurveIsThatOfItsFit) {
  for (double stops = -9.0; stops < 6.4; stops += 0.1) {
    const double x = (stops + 10.0) / 16.5;
    const double fit =
        -0.00232 +
        x * (0.1191 + x * (0.4298 + x * (-6.868 + x * (31.96 + x * (-40.14 + x * 15.5)))));
    EXPECT_NEAR(agx_curve(stops), fit, 0.006) << stops;
  }
  EXPECT_NEAR(agx_curve(0.0), 0.5, 1e-12);
  EXPECT_NEAR(agx_curve(-10.0), 0.0, 1e-12);
  EXPECT_NEAR(agx_curve(6.5), 1.0, 1e-12);
  EXPECT_NEAR((agx_curve(1e-4) - agx_curve(-1e-4)) * 16.5 / 2e-4, 2.0, 1e-3);
}

RC_GTEST_PROP(AgX, GreyStaysGreyAndHighlightsLoseSaturation, ()) {
  const double stops = *rc::gen::inRange(-90, 60) / 10.0, light = 0.18 * std::exp2(stops);
  const LinearSrgb grey = agx({light, light, light});
  RC_ASSERT(std::abs(grey[0] - grey[1]) < 1e-9 && std::abs(grey[0] - grey[2]) < 1e-9);
  RC_ASSERT(std::abs(grey[0] - std::pow(agx_curve(stops), 2.2)) < 1e-9);
  const LinearSrgb red = agx({16.0, 0.1, 0.1}), less = agx({1.0, 0.1 / 16.0, 0.1 / 16.0});
  RC_ASSERT(red[1] / red[0] > less[1] / less[0]);
}

TEST(View, StandardOnlyExposesAndCutsOff) {
  Image image = make_image(2, 1, {"A", "B", "G", "R", "normal.X"});
  image.pixels = {0.5f, 0.1f, 0.2f, 0.3f, -1.0f, 1.0f, -0.5f, std::nanf(""), 7.0f, 0.0f};
  const Image shown = view_image(image, View::standard, 1.0);
  EXPECT_EQ(shown.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
  const std::vector<float> expected = {0.6f, 0.4f, 0.2f, 0.5f, 1.0f, 0.0f, 0.0f, 1.0f};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_FLOAT_EQ(shown.pixels[i], expected[i]);
}

TEST(View, FilmicExposesFirst) {
  Image image = make_image(1, 1, {"Y"});
  image.pixels = {0.72f};
  EXPECT_NEAR(view_image(image, View::filmic, -2.0).pixels[0], 0.18f, 1e-6f);
  EXPECT_THROW((void)view_image(make_image(1, 1, {"depth"}), View::filmic), InvalidInput);
}

}  // namespace
}  // namespace lamina
