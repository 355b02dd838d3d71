// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/objective/map_smoothness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/base/core/random.h"

namespace lamina::detail {
namespace {

// A wave that meets its mirror image at the edges has precision first k² + third k⁶, with the
// square of the wave number of differences, 2 - 2 cos.
TEST(MapSmoothness, OfAWaveIsItsPrecision) {
  const GridSize size{24, 10};
  const MapSmoothness smoothness{.first = {.weight = 3.0, .share = {}},
                                 .third = {.weight = 50.0, .share = {}}};
  for (const int waves : {1, 5, 17}) {
    const double angle = std::numbers::pi * waves / size.width;
    std::vector<float> map(size.texels()), product(map.size(), 0.0f);
    double square = 0.0, along = 0.0;
    for (std::size_t t = 0; t < map.size(); ++t) {
      map[t] = static_cast<float>(std::cos(angle * (static_cast<double>(t % 24) + 0.5)));
      square += static_cast<double>(map[t]) * static_cast<double>(map[t]);
    }
    const double wave_square = 2.0 - 2.0 * std::cos(angle);
    const double precision = 3.0 * wave_square + 50.0 * std::pow(wave_square, 3);
    add_roughness_matrix(size, smoothness, map, product);
    for (std::size_t t = 0; t < map.size(); ++t)
      along += static_cast<double>(map[t]) * static_cast<double>(product[t]);
    EXPECT_NEAR(along / (precision * square), 1.0, 1e-4) << waves;
    EXPECT_NEAR(roughness(size, smoothness, map) / (precision * square), 1.0, 1e-4) << waves;
  }
}

// Of noise whose covariance is a matrix A, (x, noise)² is x A x in the mean, edges and all.
TEST(MapSmoothness, HasNoiseOfItsMatrix) {
  const GridSize size{12, 9};
  Random random = make_random(5, 0);
  MapSmoothness smoothness{.first = {.weight = 2.0, .share = {}},
                           .third = {.weight = 0.7, .share = {}}};
  std::vector<float> map;
  for (std::size_t t = 0; t < size.texels(); ++t) {
    map.push_back(random.uniform_float());
    smoothness.first.share.push_back(0.2f + random.uniform_float());
    smoothness.third.share.push_back(0.1f + random.uniform_float());
  }
  constexpr int draws = 4000;
  double sum = 0.0;
  for (int d = 0; d < draws; ++d) {
    const std::vector<float> noise =
        roughness_noise(size, smoothness, [&] { return random.bits() >> 63 ? 1.0f : -1.0f; });
    double product = 0.0;
    for (std::size_t t = 0; t < map.size(); ++t)
      product += static_cast<double>(map[t]) * static_cast<double>(noise[t]);
    sum += product * product / draws;
  }
  EXPECT_NEAR(sum / roughness(size, smoothness, map), 1.0, 5.0 * std::sqrt(2.0 / draws));
}

}  // namespace
}  // namespace lamina::detail
