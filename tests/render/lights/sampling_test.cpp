// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "lamina/base/core/low_discrepancy.h"
#include "lamina/base/core/random.h"
#include "lamina/render/lights/internal/environment.h"
#include "lamina/scene/surface/noise.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;

// A (0, 2)-sequence: of its first 2^k points one lies in each box of area 2^-k of every shape.
TEST(PixelSamples, EveryPairIsStratifiedInAllElementaryBoxes) {
  constexpr int k = 6, count = 1 << k;
  for (int dimension : {0, 1, 5})
    for (int split = 0; split <= k; ++split) {
      std::set<int> boxes;
      for (std::uint32_t i = 0; i < count; ++i) {
        PixelSamples samples(3, 77, i);
        for (int skip = 0; skip < dimension; ++skip) (void)samples.next_2d();
        const Vec2f u = samples.next_2d();
        boxes.insert(static_cast<int>(u.x * static_cast<float>(1 << split)) * count +
                     static_cast<int>(u.y * static_cast<float>(1 << (k - split))));
      }
      EXPECT_EQ(boxes.size(), static_cast<std::size_t>(count)) << dimension << ' ' << split;
    }
}

// Owen scrambling makes each point uniform and different pixels and dimensions independent: the
// mean of x y over many pixels is 1/4 with a standard error of sqrt(7/144 / n).
TEST(PixelSamples, PixelsAndDimensionsAreUncorrelated) {
  constexpr std::uint32_t pixels = 100'000;
  double within = 0.0, across = 0.0, neighbours = 0.0;
  float last = 0.5f;
  for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
    PixelSamples samples(1, pixel, 0);
    const Vec2f a = samples.next_2d(), b = samples.next_2d();
    within += static_cast<double>(a.x * a.y);
    across += static_cast<double>(a.x * b.x);
    neighbours += static_cast<double>(a.x * last);
    last = a.x;
  }
  const double tolerance = 4.0 * std::sqrt(7.0 / 144.0 / pixels);
  EXPECT_NEAR(within / pixels, 0.25, tolerance);
  EXPECT_NEAR(across / pixels, 0.25, tolerance);
  EXPECT_NEAR(neighbours / pixels, 0.25, tolerance);
}

/// A dim sky with a sun of one pixel, as bright as in the outdoor maps.
Image sunny_sky() {
  Image image = make_image(64, 32, {"R", "G", "B"});
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y)[c] = 0.2f + 0.01f * static_cast<float>(y) + 0.003f * static_cast<float>(x);
  for (int c = 0; c < 3; ++c) image.at(40, 9)[c] = 6500.0f;
  return image;
}

// As a search by halves finds it, with ends far apart, in heaps and alike.
TEST(SegmentSearch, FindsTheFirstEndAbove) {
  Random random(4);
  for (const float power : {0.2f, 1.0f, 20.0f}) {
    std::vector<float> ends;
    for (int i = 0; i < 300; ++i) ends.push_back(std::pow(random.uniform_float(), power));
    ends.insert(ends.end(), {0.0f, 0.5f, 0.5f, 1.0f});
    std::ranges::sort(ends);
    const SegmentSearch search(ends);
    std::vector<float> numbers = ends;
    for (int i = 0; i < 2000; ++i) numbers.push_back(random.uniform_float());
    for (const float x : numbers) {
      const auto above = std::ranges::upper_bound(ends, x) - ends.begin();
      EXPECT_EQ(search.find(ends, x),
                std::min<std::size_t>(static_cast<std::size_t>(above), ends.size() - 1))
          << x;
    }
  }
}

TEST(Environment, DensityIntegratesToOne) {
  const Environment sky(sunny_sky(), {1, 1, 1}, 0.7f);
  // Midpoint rule on 16 by 16 points per pixel; the bilinear density bends at pixel centres, so the
  // error is of second order in 1/16.
  double integral = 0.0;
  constexpr int rows = 512, columns = 1024;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double theta = pi * (i + 0.5) / rows, phi = 2.0 * pi * (j + 0.5) / columns;
      const Vec3 w{std::sin(theta) * std::sin(phi), std::cos(theta),
                   std::sin(theta) * std::cos(phi)};
      const auto seen =
          sky.evaluate({static_cast<float>(w.x), static_cast<float>(w.y), static_cast<float>(w.z)});
      integral += static_cast<double>(seen.pdf) * std::sin(theta) * pi / rows * 2.0 * pi / columns;
    }
  EXPECT_NEAR(integral, 1.0, 4e-3);
}

TEST(Environment, DrawnDirectionsCarryTheirOwnDensity) {
  const Environment sky(sunny_sky(), {1, 2, 3}, -1.1f);
  Random random(5);
  for (int i = 0; i < 10'000; ++i) {
    const auto drawn = sky.sample({random.uniform_float(), random.uniform_float()});
    EXPECT_NEAR(length(drawn.direction), 1.0f, 1e-5f);
    const auto seen = sky.evaluate(drawn.direction);
    // A float direction is off by 1e-7, which at the slope of the sun is 1e-5 of its brightness.
    EXPECT_NEAR(seen.pdf, drawn.seen.pdf, 2e-3f * drawn.seen.pdf + 1e-3f);
    EXPECT_NEAR(seen.radiance.y, drawn.seen.radiance.y, 2e-3f * drawn.seen.radiance.y + 0.2f);
  }
}

// The mean over drawn directions of weight / density is the integral of the weight, without
// outliers: the density follows the brightness above the mean, so the ratio stays bounded.
TEST(Environment, ASunGivesNoOutliers) {
  const Environment sky(sunny_sky(), {1, 1, 1}, 0.0f);
  Random random(6);
  float top = 0.0f;
  for (int i = 0; i < 100'000; ++i) {
    const auto [direction, seen] = sky.sample({random.uniform_float(), random.uniform_float()});
    // With the part that surfaces sample better taken out by the balance heuristic.
    top = std::max(top, seen.radiance.x / (seen.pdf + 0.25f / std::numbers::pi_v<float>));
  }
  const double even = 4.0 * pi * static_cast<double>(sky.mean_radiance().x);
  EXPECT_LT(static_cast<double>(top), 3.0 * even);
}

TEST(Environment, PolesAndRotationPointWhereTheySay) {
  Image image = make_image(8, 4, {"R", "G", "B"});
  for (int x = 0; x < 8; ++x) image.at(x, 0)[0] = 1.0f;  // red top
  for (int y = 1; y < 4; ++y) image.at(4, y)[1] = 1.0f;  // green just right of the middle
  const Environment sky(image, {1, 1, 1}, 0.0f);
  EXPECT_FLOAT_EQ(sky.evaluate({0, 1, 0}).radiance.x, 1.0f);
  EXPECT_FLOAT_EQ(sky.evaluate({0, -1, 0}).radiance.x, 0.0f);
  const float a = 0.125f * std::numbers::pi_v<float>;  // the centre of pixel 4 is right of -z
  EXPECT_NEAR(sky.evaluate({std::sin(a), 0, -std::cos(a)}).radiance.y, 1.0f, 1e-5f);
  // Turned by +90 degrees about +y, what was at -z is at -x.
  const Environment turned(image, {1, 1, 1}, 0.5f * std::numbers::pi_v<float>);
  EXPECT_NEAR(turned.evaluate({-std::cos(a), 0, -std::sin(a)}).radiance.y, 1.0f, 1e-5f);
}

TEST(Noise, SmoothNoiseHasMeanZeroAndUnitVariance) {
  Random random(8);
  for (const int octaves : {1, 4}) {
    const NoiseMap noise{.size = 2.0f, .octaves = octaves, .seed = 3};
    double sum = 0.0, sum2 = 0.0;
    constexpr int count = 200'000;
    for (int i = 0; i < count; ++i) {
      const Vec3f p{200.0f * random.uniform_float(), 200.0f * random.uniform_float(),
                    200.0f * random.uniform_float()};
      const double value = static_cast<double>(evaluate_noise(noise, p, 1e-3f));
      sum += value;
      sum2 += value * value;
    }
    EXPECT_NEAR(sum / count, 0.0, 0.02);
    EXPECT_NEAR(sum2 / count, 1.0, 0.03) << octaves;
  }
}

TEST(Noise, FadesToItsMeanWhereTooFineToSee) {
  Random random(9);
  for (const auto kind : {NoiseMap::Kind::smooth, NoiseMap::Kind::cellular}) {
    const NoiseMap noise{.kind = kind, .size = 0.5f, .octaves = 2, .seed = 1};
    double mean = 0.0;
    constexpr int count = 100'000;
    for (int i = 0; i < count; ++i) {
      const Vec3f p{50.0f * random.uniform_float(), 50.0f * random.uniform_float(),
                    50.0f * random.uniform_float()};
      const float value = evaluate_noise(noise, p, 1e-4f);
      if (kind == NoiseMap::Kind::cellular) {
        EXPECT_GE(value, 0.0f);
        EXPECT_LE(value, 1.0f);
      }
      mean += static_cast<double>(value) / count;
    }
    EXPECT_NEAR(static_cast<double>(evaluate_noise(noise, {1, 2, 3}, 10.0f)), mean, 0.02);
  }
}

}  // namespace
}  // namespace lamina
