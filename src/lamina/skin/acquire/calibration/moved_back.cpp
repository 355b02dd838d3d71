// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/skin/acquire/calibration/internal/cubic_lookup.h"
#include "lamina/skin/acquire/calibration/registration.h"

namespace lamina {
namespace {

bool is_still(const ImageMotion& motion) {
  return motion.shift == Vec2{} && motion.scale == 1.0 && motion.rotation == 0.0;
}

/// One number of an image between its pixels.
struct MovedNumber {
  double value = 0.0, variance = 0.0;
  unsigned faults = 0;
};

MovedNumber number_at(const Developed& image, std::size_t channel, Vec2 place) {
  constexpr double no_weight = 1e-3;  // such pixels may have faults
  const CubicLookup across = cubic_lookup(place.x), down = cubic_lookup(place.y);
  MovedNumber result;
  double squares = 0.0, weights = 0.0;
  for (std::size_t j = 0; j < 4; ++j)
    for (std::size_t i = 0; i < 4; ++i) {
      const double weight = across.weights[i] * down.weights[j];
      if (std::abs(weight) < no_weight) continue;
      const int x = across.first + static_cast<int>(i), y = down.first + static_cast<int>(j);
      if (x < 0 || y < 0 || x >= image.mask.width || y >= image.mask.height) {
        result.faults |= static_cast<unsigned>(PixelFault::unseen);
        continue;
      }
      result.faults |= image.mask.faults[image.mask.index(x, y)];
      const auto deviation = static_cast<double>(image.deviation.at(x, y)[channel]);
      result.value += weight * static_cast<double>(image.reflectance.at(x, y)[channel]);
      result.variance += weight * weight * deviation * deviation;
      squares += weight * weight;
      weights += weight;
    }
  if (squares > 0.0) result.variance /= squares;
  if (weights > 0.0) result.value /= weights;
  return result;
}

}  // namespace

Developed moved_back(const Developed& image, std::span<const ImageMotion> motions) {
  const std::size_t channels = image.reflectance.channel_count();
  if (motions.size() != channels)
    throw InvalidInput("registration: a motion is required for each of the " +
                       std::to_string(channels) + " channels, but there are " +
                       std::to_string(motions.size()));
  Developed result = image;
  parallel_for(static_cast<std::size_t>(image.mask.height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < image.mask.width; ++x) {
      unsigned faults = image.mask.faults[image.mask.index(x, y)];
      for (std::size_t c = 0; c < channels; ++c) {
        if (is_still(motions[c])) continue;
        const MovedNumber number = number_at(
            image, c, moved(motions[c], {x + 0.5, y + 0.5}, image.mask.width, image.mask.height));
        faults |= number.faults;
        result.reflectance.at(x, y)[c] = static_cast<float>(number.value);
        result.deviation.at(x, y)[c] = static_cast<float>(std::sqrt(number.variance));
      }
      result.mask.faults[image.mask.index(x, y)] = static_cast<std::uint8_t>(faults);
      for (std::size_t c = 0; c < channels && faults != 0; ++c)
        result.reflectance.at(x, y)[c] = result.deviation.at(x, y)[c] = 0.0f;
    }
  });
  return result;
}

}  // namespace lamina
