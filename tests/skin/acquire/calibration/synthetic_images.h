// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "lamina/base/core/random.h"
#include "lamina/base/image/image.h"

// Images of known truth.

namespace lamina {

inline double normal_number(Random& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * random.uniform());
}

/// An image of a function of pixel centres and channel, value(x, y, channel).
template <class Value>
Image image_of(int width, int height, std::vector<std::string> channels, const Value& value) {
  Image image = make_image(width, height, std::move(channels));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (std::size_t c = 0; c < image.channel_count(); ++c)
        image.at(x, y)[c] = static_cast<float>(value(x + 0.5, y + 0.5, c));
  return image;
}

/// Adds noise of variance read_variance + gain * value.
inline void add_noise(Image& image, double read_variance, double gain, std::uint64_t seed) {
  Random random = make_random(seed, 0);
  for (float& v : image.pixels) {
    const double value = static_cast<double>(v);
    v = static_cast<float>(value + std::sqrt(read_variance + gain * value) * normal_number(random));
  }
}

/// Texture of skin from near: spots of some pixels, about 1, at any place.
/// @param contrast  of the spots, 0.1 say
inline double skin_texture(double x, double y, double contrast) {
  double sum = 0.0;
  for (int i = 0; i < 12; ++i) {
    const double angle = 2.4 * i, wave = 0.08 + 0.045 * i;  // [rad/pixel]
    sum += std::sin(wave * (x * std::cos(angle) + y * std::sin(angle)) + 1.7 * i * i);
  }
  return 1.0 + contrast * std::tanh(0.5 * sum);
}

}  // namespace lamina
