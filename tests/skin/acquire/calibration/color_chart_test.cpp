// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/color_chart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/skin/acquire/calibration/light_window.h"
#include "skin/acquire/calibration/synthetic_images.h"

namespace lamina {
namespace {

constexpr auto edition = ColorChartEdition::before_november_2014;
constexpr Matrix3 camera_matrix = {{{0.5, 0.3, 0.05}, {0.15, 0.6, 0.1}, {0.03, 0.2, 0.4}}};

/// A chart in perspective before a background that grows brighter, seen by a camera in noise.
struct ChartPhotograph {
  Vec2 middle{200.0, 150.0};
  double size = 40.0, angle = 0.3, perspective = 0.02, noise = 0.004, fading = 0.0;
  int width = 400, height = 300;

  /// Of the chart's coordinates: patches are at whole numbers, from (0, 0) to (5, 3).
  Vec2 seen(Vec2 chart) const {
    const Vec2 p{chart.x - 2.5, chart.y - 1.5};
    const Vec2 q{p.x * std::cos(angle) - p.y * std::sin(angle),
                 p.x * std::sin(angle) + p.y * std::cos(angle)};
    const double w = 1.0 + perspective * (q.x + 0.5 * q.y);
    return {middle.x + size * q.x / w, middle.y + size * q.y / w};
  }
  Vec2 on_chart(Vec2 place) const {  // q = w d, w = 1 + p (q.x + q.y / 2)
    const Vec2 d{(place.x - middle.x) / size, (place.y - middle.y) / size};
    const double w = 1.0 / (1.0 - perspective * (d.x + 0.5 * d.y));
    const Vec2 q{w * d.x, w * d.y};
    return {2.5 + q.x * std::cos(angle) + q.y * std::sin(angle),
            1.5 - q.x * std::sin(angle) + q.y * std::cos(angle)};
  }
  ChartCorners corners() const { return {seen({0, 0}), seen({5, 0}), seen({5, 3}), seen({0, 3})}; }
  Image photograph(std::uint64_t seed = 1) const {
    const auto colors = chart_srgb(edition);
    Image image = image_of(width, height, {"R", "G", "B"}, [&](double x, double y, std::size_t c) {
      double sum = 0.0;
      for (const double dx : {-0.25, 0.25})
        for (const double dy : {-0.25, 0.25}) {
          const Vec2 p = on_chart({x + dx, y + dy});
          const double column = std::round(p.x), row = std::round(p.y);
          const bool on_card = p.x > -0.7 && p.x < 5.7 && p.y > -0.7 && p.y < 3.7;
          const bool on_patch = on_card && column >= 0 && column < 6 && row >= 0 && row < 4 &&
                                std::abs(p.x - column) < 0.44 && std::abs(p.y - row) < 0.44;
          LinearSrgb color{0.1 + 0.001 * x, 0.15 + 0.0008 * y, 0.2};
          if (on_card) color = {0.025, 0.025, 0.025};
          if (on_patch)
            color = colors[static_cast<std::size_t>(row) * 6 + static_cast<std::size_t>(column)];
          sum += (camera_matrix * color)[c] / 4.0;
        }
      return sum * (1.0 - fading * x / width);
    });
    add_noise(image, 0.25 * noise * noise, noise * noise, seed);
    return image;
  }
};

double largest_distance(const ChartCorners& a, const ChartCorners& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < 4; ++i)
    largest = std::max(largest, std::hypot(a[i].x - b[i].x, a[i].y - b[i].y));
  return largest;
}

// Against linear sRGB of another program from the same colors: white, cyan, neutral 8.
TEST(ColorChart, HasTheColorsOfItsMaker) {
  const auto colors = chart_srgb(edition);
  const auto expect_color = [&](std::size_t patch, const LinearSrgb& expected) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(colors[patch][c], expected[c], 1e-3) << patch;
  };
  expect_color(18, {0.912627, 0.914939, 0.893670});
  expect_color(17, {-0.037406, 0.246995, 0.400412});
  expect_color(19, {0.579819, 0.592004, 0.593289});
  for (std::size_t i = 19; i < 23; ++i) EXPECT_LT(colors[i][1], colors[i - 1][1]);
  const auto later = chart_colors(ColorChartEdition::from_november_2014);
  for (std::size_t i = 0; i < chart_patches; ++i)
    EXPECT_LT(color_difference(chart_colors(edition)[i].lab, later[i].lab), 2.5);
}

TEST(ColorChart, IsFoundInPerspectiveAndNoise) {
  for (const ChartPhotograph& truth :
       {ChartPhotograph{}, ChartPhotograph{.size = 24.0, .angle = 2.0, .noise = 0.01},
        ChartPhotograph{
            .middle = {180.0, 160.0}, .angle = -1.4, .perspective = 0.05, .fading = 0.15},
        ChartPhotograph{.angle = 3.3, .perspective = -0.04}}) {
    const ChartReading reading = find_color_chart(truth.photograph(), "a.tif");
    EXPECT_LT(largest_distance(reading.corners, truth.corners()), 0.06 * truth.size)
        << "turned by " << truth.angle;
    const auto samples = color_samples(reading, edition);
    ASSERT_EQ(samples.size(), chart_patches);
    if (truth.fading == 0.0)
      for (const ColorSample& sample : samples) {
        const auto expected = camera_matrix * sample.reference;
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(sample.camera[c], expected[c], 0.004);
      }
  }
}

TEST(ColorChart, HasAnOutlineAroundItsPatches) {
  const ChartPhotograph truth{.size = 30.0, .angle = 0.4};
  const Image inside = polygon_image(chart_outline(truth.corners()), truth.width, truth.height);
  for (int y = 0; y < truth.height; ++y)
    for (int x = 0; x < truth.width; ++x) {
      const Vec2 p = truth.on_chart({x + 0.5, y + 0.5});
      const bool is_patch = p.x > -0.5 && p.x < 5.5 && p.y > -0.5 && p.y < 3.5;
      const bool is_far = p.x < -0.85 || p.x > 5.85 || p.y < -0.85 || p.y > 3.85;
      if (is_patch || is_far) {
        ASSERT_NEAR(inside.at(x, y)[0], is_patch ? 1.0f : 0.0f, 1e-4f) << x << ", " << y;
      }
    }
}

TEST(ColorChart, IsReadAtGivenCorners) {
  const ChartPhotograph truth{.size = 30.0};
  const Image image = truth.photograph();
  const ChartReading reading =
      read_color_chart(image, truth.corners(), "a.tif", {.saturation = 0.5});
  EXPECT_GT(reading.patches[18].saturated, 0u);
  EXPECT_EQ(reading.patches[23].saturated, 0u);
  EXPECT_LT(color_samples(reading, edition).size(), chart_patches);
  EXPECT_NEAR(reading.patches[19].deviation[1], 0.002, 0.002);

  const auto refuses = [&](ChartCorners corners, double saturation = 1.0) {
    EXPECT_THROW(
        (void)color_samples(read_color_chart(image, corners, "a.tif", {.saturation = saturation}),
                            edition),
        InvalidInput);
  };
  ChartCorners corners = truth.corners();
  refuses(corners, 0.05);
  refuses({corners[0], corners[3], corners[2], corners[1]});  // the wrong way round
  refuses({corners[0], corners[2], corners[1], corners[3]});
  refuses({corners[0], corners[0], corners[2], corners[3]});
  refuses({Vec2{100, 100}, {110, 100}, {110, 106}, {100, 106}});
  refuses({Vec2{100, 100}, {999, 100}, {999, 200}, {100, 200}});
  corners[0].x = std::nan("");
  refuses(corners);
}

TEST(ColorChart, IsNotFoundWhereThereIsNone) {
  const auto refuses = [](const Image& image) {
    EXPECT_THROW((void)find_color_chart(image, "a.tif"), InvalidInput);
  };
  const std::vector<std::string> rgb = {"R", "G", "B"};
  refuses(make_image(64, 64, rgb));
  Image skin = image_of(400, 300, rgb, [](double x, double y, std::size_t c) {
    return (c == 0 ? 0.5 : c == 1 ? 0.3 : 0.2) * skin_texture(0.3 * x, 0.3 * y, 0.2);
  });
  refuses(skin);
  add_noise(skin, 1e-5, 0.0, 2);
  refuses(skin);
  const auto tile = [](double x, double y) {
    return std::fmod(x, 40.0) > 5.0 && std::fmod(y, 40.0) > 5.0;
  };
  refuses(image_of(400, 300, rgb, [&](double x, double y, std::size_t) {  // tiles of one color
    return tile(x, y) ? 0.5 : 0.1;
  }));
  refuses(image_of(400, 300, rgb, [&](double x, double y, std::size_t c) {  // of other colors
    const int i = static_cast<int>(x / 40.0) + 11 * static_cast<int>(y / 40.0);
    return tile(x, y) ? 0.1 + 0.08 * ((i * 7 + static_cast<int>(c) * i * 5) % 11) : 0.02;
  }));
  EXPECT_THROW((void)find_color_chart(make_image(64, 64, {"Y"}), "a.tif"), InvalidInput);
}

TEST(ColorCorrection, InvertsACameraThatIsAMatrix) {
  const auto samples =
      color_samples(find_color_chart(ChartPhotograph{}.photograph(), "a.tif"), edition);
  const ColorCorrection correction = fit_color_correction(samples);
  EXPECT_LT(correction.mean_left_out_error, 0.5);
  EXPECT_LE(correction.mean_error, correction.mean_left_out_error);
  const Matrix3 one = correction.matrix * camera_matrix;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(one[i][j], i == j ? 1.0 : 0.0, 0.02);
}

// Errors of the camera by a known scatter: the matrix's covariance has it, over repetitions.
TEST(ColorCorrection, KnowsItsErrors) {
  const auto colors = chart_srgb(edition);
  Random random = make_random(3, 0);
  double squares = 0.0, expected = 0.0;
  constexpr int count = 150;
  constexpr std::array<double, 3> skin = {0.25, 0.2, 0.12};
  const LinearSrgb truth = inverse(camera_matrix) * skin;
  for (int i = 0; i < count; ++i) {
    std::vector<ColorSample> samples;
    for (const LinearSrgb& color : colors) {
      ColorSample sample{camera_matrix * color, color};
      for (double& v : sample.camera) v *= 1.0 + 0.02 * normal_number(random);
      samples.push_back(sample);
    }
    const ColorCorrection correction = fit_color_correction(samples);
    squares += std::pow((correction.matrix * skin)[0] - truth[0], 2) / count;
    expected += correction_covariance(correction, skin)[0][0] / count;
  }
  EXPECT_NEAR(std::sqrt(squares / expected), 1.0, 0.35);
}

TEST(ColorCorrection, CarriesNoiseOn) {
  Image image = make_image(2, 1, {"B", "G", "R"}), deviation = image;
  image.pixels = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f};
  deviation.pixels = {0.01f, 0.02f, 0.03f, 0.0f, 0.0f, 0.04f};
  const CorrectedImage result = corrected_colors(image, deviation, camera_matrix);
  EXPECT_NEAR(result.color.at(0, 0)[0], 0.5 * 0.3 + 0.3 * 0.2 + 0.05 * 0.1, 1e-6);
  EXPECT_NEAR(result.deviation.at(0, 0)[0], std::hypot(0.015, 0.006, 0.0005), 1e-7);
  EXPECT_NEAR(result.deviation.at(1, 0)[1], 0.15 * 0.04, 1e-7);
  EXPECT_THROW((void)corrected_colors(image, make_image(1, 1, {"R", "G", "B"}), camera_matrix),
               InvalidInput);
  std::vector<ColorSample> gray(24, {{0.2, 0.2, 0.2}, {0.3, 0.3, 0.3}});
  EXPECT_THROW((void)fit_color_correction(gray), InvalidInput);
  EXPECT_THROW((void)fit_color_correction(std::span(gray).first(5)), InvalidInput);
}

}  // namespace
}  // namespace lamina
