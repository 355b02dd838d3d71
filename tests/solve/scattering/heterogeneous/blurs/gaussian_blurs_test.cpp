// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/blurs/gaussian_blurs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "lamina/solve/scattering/heterogeneous/blurs/texel_operators.h"

namespace lamina {
namespace {

/// The operator that is one scale, or a sum of scales.
MappedOperator constant_operator(std::vector<float> weights) {
  const float total = std::accumulate(weights.begin(), weights.end(), 0.0f);
  return {.terms = 1, .weights = std::move(weights), .totals = {total}};
}

Plane apply_scales(const BlurPyramid& pyramid, const Plane& input, std::vector<float> weights) {
  const MappedOperator blur = constant_operator(std::move(weights));
  const MappedOperator* operators[] = {&blur};
  return apply_operators(pyramid, input, {make_plane(pyramid.width, pyramid.height)}, operators)[0];
}

Plane one_scale(const BlurPyramid& pyramid, const Plane& input, std::size_t scale) {
  std::vector<float> weights(pyramid.variances.size(), 0.0f);
  weights[scale] = 1.0f;
  return apply_scales(pyramid, input, weights);
}

std::vector<float> scales_of(const BlurPyramid& pyramid, double variance) {
  const double variances[] = {variance};
  const std::vector<double> scales = scales_of_gaussians(pyramid, variances);
  return {scales.begin(), scales.end()};
}

Plane noise(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  Plane plane = make_plane(width, height);
  for (float& value : plane.values) value = std::uniform_real_distribution<float>()(random);
  return plane;
}

TEST(GaussianBlurs, KeepTheLight) {
  const BlurPyramid pyramid = make_blur_pyramid(64, 96, 500.0);
  const Plane light = noise(64, 96, 1);
  const double all = std::accumulate(light.values.begin(), light.values.end(), 0.0);
  for (std::size_t scale = 0; scale < pyramid.variances.size(); ++scale) {
    const Plane seen = one_scale(pyramid, light, scale);
    EXPECT_NEAR(std::accumulate(seen.values.begin(), seen.values.end(), 0.0), all, 1e-5 * all);
  }
}

TEST(GaussianBlurs, WidenASpotByTheirVariance) {
  const BlurPyramid pyramid = make_blur_pyramid(256, 256, 200.0);
  Plane spot = make_plane(256, 256);
  spot.values[128 * 256 + 125] = 1.0f;
  for (std::size_t scale = 0; pyramid.variances[scale] < 200.0; ++scale) {
    const Plane seen = one_scale(pyramid, spot, scale);
    double sum = 0.0, square_x = 0.0, square_y = 0.0;
    for (int y = 0; y < 256; ++y)
      for (int x = 0; x < 256; ++x) {
        const double value = seen.values[static_cast<std::size_t>(y * 256 + x)];
        sum += value;
        square_x += value * (x - 125) * (x - 125);
        square_y += value * (y - 128) * (y - 128);
      }
    // A spot sits askew on coarser grids, by up to half a texel of theirs.
    const double tolerance = 2e-3 + 0.02 * pyramid.variances[scale];
    EXPECT_NEAR(sum, 1.0, 1e-5);
    EXPECT_NEAR(square_x, pyramid.variances[scale], tolerance);
    EXPECT_NEAR(square_y, pyramid.variances[scale], tolerance);
  }
}

TEST(GaussianBlurs, AreTheirOwnAdjoints) {
  const BlurPyramid pyramid = make_blur_pyramid(48, 80, 300.0);
  const Plane a = noise(48, 80, 1), b = noise(48, 80, 2);
  std::vector<float> weights;
  for (std::size_t scale = 0; scale < pyramid.variances.size(); ++scale)
    weights.push_back(1.0f / static_cast<float>(1 + scale));
  const auto dot = [](const Plane& p, const Plane& q) {
    return std::inner_product(p.values.begin(), p.values.end(), q.values.begin(), 0.0);
  };
  const double forward = dot(b, apply_scales(pyramid, a, weights));
  const double backward = dot(a, apply_scales(pyramid, b, weights));
  EXPECT_NEAR(forward, backward, 1e-6 * forward);
}

// The blur of a sharp edge is an error function of the distance to it.
TEST(GaussianBlurs, SumsOfScalesBlurEdgesLikeGaussians) {
  constexpr int size = 256;
  const BlurPyramid pyramid = make_blur_pyramid(size, size, 1000.0);
  Plane edge = make_plane(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 101; x < size; ++x) edge.values[static_cast<std::size_t>(y * size + x)] = 1.0f;
  for (const double variance : {6.0, 10.0, 25.0, 70.0, 300.0, 900.0}) {
    const Plane seen = apply_scales(pyramid, edge, scales_of(pyramid, variance));
    for (int x = 20; x < 180; ++x) {
      // A texel's light is its mean: the edge stands between two of them.
      const double wanted = 0.5 * std::erfc((100.5 - x) / std::sqrt(2.0 * variance));
      ASSERT_NEAR(seen.values[static_cast<std::size_t>(70 * size + x)], wanted, 5e-3)
          << "variance " << variance << ", texel " << x;
    }
  }
}

TEST(GaussianBlurs, NarrowOnesFadeTheFinestStripes) {
  const BlurPyramid pyramid = make_blur_pyramid(64, 64, 100.0);
  Plane checks = make_plane(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      checks.values[static_cast<std::size_t>(y * 64 + x)] = x % 2 == 0 ? 1.0f : 0.0f;
  // By exp(-v 1 - cos pi) on the grid, and a little more: see scales_of_gaussians.
  for (const double variance : {0.05, 0.3, 0.6, 1.5}) {
    const Plane seen = apply_scales(pyramid, checks, scales_of(pyramid, variance));
    EXPECT_NEAR(seen.values[32 * 64 + 32] - seen.values[32 * 64 + 33], std::exp(-2.5 * variance),
                2e-3);
  }
}

TEST(GaussianBlurs, WeightsFollowTheCoordinateWhereLightComesOut) {
  const BlurPyramid pyramid = make_blur_pyramid(32, 32, 50.0);
  const Plane light = noise(32, 32, 3);
  Plane coordinate = noise(32, 32, 4);
  const std::size_t scales = pyramid.variances.size();
  MappedOperator both{.terms = 3, .weights = std::vector<float>(3 * scales), .totals = {}};
  std::mt19937 random(5);
  for (float& w : both.weights) w = std::uniform_real_distribution<float>(-1.0f, 1.0f)(random);
  const MappedOperator* operators[] = {&both};
  const Plane seen = apply_operators(pyramid, light, {coordinate}, operators)[0];
  std::vector<Plane> powers;
  for (std::size_t p = 0; p < 3; ++p)
    powers.push_back(
        apply_scales(pyramid, light,
                     {both.weights.begin() + static_cast<std::ptrdiff_t>(p * scales),
                      both.weights.begin() + static_cast<std::ptrdiff_t>((p + 1) * scales)}));
  for (std::size_t i = 0; i < seen.values.size(); ++i) {
    const float x = coordinate.values[i];
    ASSERT_NEAR(seen.values[i],
                powers[0].values[i] + x * (powers[1].values[i] + x * powers[2].values[i]), 2e-5);
  }
}

// Method of images: a lit strip, its mirror image at either end, and so on.
double blurred_strip(double x, double begin, double end, double size, double variance) {
  const double scale = 1.0 / std::sqrt(2.0 * variance);
  double light = 0.0;
  for (int period = -40; period <= 40; ++period)
    for (const double side : {1.0, -1.0}) {
      const double from = 2.0 * size * period - x;
      light += 0.5 * side *
               (std::erf((from + side * end) * scale) - std::erf((from + side * begin) * scale));
    }
  return light;
}

// Sides that are multiples of no power of two are like any other.
TEST(GaussianBlurs, PlanesOfAnySizeEndInMirrors) {
  for (int size = 31; size <= 65; ++size) {
    const int height = 96 - size;
    const BlurPyramid pyramid = make_blur_pyramid(size, height, 1000.0);
    // Light on the third quarter of the width: it is not symmetric itself.
    Plane strip = make_plane(size, height), mirror = strip;
    const int begin = size / 2, end = 3 * size / 4;
    for (int y = 0; y < height; ++y)
      for (int x = begin; x < end; ++x) {
        strip.values[static_cast<std::size_t>(y * size + x)] = 1.0f;
        mirror.values[static_cast<std::size_t>(y * size + size - 1 - x)] = 1.0f;
      }
    for (const double variance : {0.7, 4.0, 9.0, 40.0, 100.0, 250.0, 1000.0}) {
      const std::vector<float> scales = scales_of(pyramid, variance);
      const Plane seen = apply_scales(pyramid, strip, scales);
      const Plane opposite = apply_scales(pyramid, mirror, scales);
      const double all = std::accumulate(seen.values.begin(), seen.values.end(), 0.0);
      EXPECT_NEAR(all, (end - begin) * height, 2e-5 * all)
          << size << " texels, variance " << variance;
      for (int x = 0; x < size; ++x) {
        const auto at = static_cast<std::size_t>(x), row = static_cast<std::size_t>(7 * size);
        ASSERT_NEAR(seen.values[row + at],
                    opposite.values[row + static_cast<std::size_t>(size - 1 - x)], 1e-5)
            << size << " texels, variance " << variance << ", texel " << x;
        // A narrower edge is as sharp as texels are; a wider one than the plane fits no scale.
        if (variance < 6.0 || variance > 300.0) continue;
        ASSERT_NEAR(seen.values[row + at], blurred_strip(x + 0.5, begin, end, size, variance), 0.01)
            << size << " texels, variance " << variance << ", texel " << x;
      }
    }
  }
}

// Short waves fold back on coarser grids, askew: see BlurPyramid.
TEST(GaussianBlurs, PlanesOfAnySizeExchangeLightAlike) {
  for (const auto& [width, height] : {std::pair{32, 48}, {31, 45}, {33, 64}, {61, 37}, {5, 9}}) {
    const BlurPyramid pyramid = make_blur_pyramid(width, height, 300.0);
    Plane a = noise(width, height, 1), b = noise(width, height, 2);
    for (Plane* plane : {&a, &b})
      for (float& value : plane->values) value -= 0.5f;
    const auto dot = [](const Plane& p, const Plane& q) {
      return std::inner_product(p.values.begin(), p.values.end(), q.values.begin(), 0.0);
    };
    for (std::size_t scale = 0; scale < pyramid.variances.size(); ++scale) {
      const Plane of_a = one_scale(pyramid, a, scale), of_b = one_scale(pyramid, b, scale);
      EXPECT_NEAR(dot(a, of_b), dot(b, of_a), 2e-3 * std::sqrt(dot(of_a, of_a) * dot(b, b)) + 1e-6)
          << width << " x " << height << ", scale " << scale;
    }
  }
}

TEST(GaussianBlurs, UniformLightStaysUniformOnPlanesOfAnySize) {
  for (const auto& [width, height] : {std::pair{31, 45}, {33, 64}, {61, 37}, {5, 9}, {1, 2}}) {
    const BlurPyramid pyramid = make_blur_pyramid(width, height, 300.0);
    for (std::size_t scale = 0; scale < pyramid.variances.size(); ++scale)
      for (const float value : one_scale(pyramid, make_plane(width, height, 1.0f), scale).values)
        ASSERT_NEAR(value, 1.0f, 2e-6f) << width << " x " << height << ", scale " << scale;
  }
}

}  // namespace
}  // namespace lamina
