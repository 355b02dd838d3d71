// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/gray_card.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/skin/acquire/calibration/internal/channel_values.h"

namespace lamina {

CardReading read_card(const Image& image, const PixelMask& card, double saturation,
                      const std::string& name) {
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput(name + ": the gray card " + why);
  };
  require_size(card, image, name + ": the mask of the gray card");
  const std::size_t channels = image.channel_count();
  CardReading reading{.mean = std::vector<double>(channels),
                      .deviation = std::vector<double>(channels)};
  std::vector<double> squares(channels);
  std::size_t saturated = 0;
  for (std::size_t pixel = 0; pixel < card.faults.size(); ++pixel) {
    if (card.faults[pixel] != 0) continue;
    ++reading.pixels;
    bool is_saturated = false;
    for (std::size_t c = 0; c < channels; ++c) {
      const auto value = static_cast<double>(image.pixels[pixel * channels + c]);
      if (!std::isfinite(value)) refuse("must be finite, but is " + number_text(value));
      is_saturated = is_saturated || value >= saturation;
      reading.mean[c] += value;
      squares[c] += value * value;
    }
    saturated += is_saturated ? 1 : 0;
  }
  if (reading.pixels < 16)
    refuse("must have at least 16 pixels, but has " + std::to_string(reading.pixels));
  if (100 * saturated > reading.pixels)
    refuse("is saturated in " + std::to_string(saturated) + " of " +
           std::to_string(reading.pixels) + " pixels: expose less");
  const auto count = static_cast<double>(reading.pixels);
  for (std::size_t c = 0; c < channels; ++c) {
    double& mean = reading.mean[c];
    mean /= count;
    if (!(mean > 0.0))
      refuse("must be brighter than 0, but has a mean of " + number_text(mean) + " in " +
             image.channels[c]);
    reading.deviation[c] = std::sqrt(std::max(0.0, squares[c] / count - mean * mean));
    if (reading.deviation[c] > 0.2 * mean)
      refuse("must be uniform, but varies by " + number_text(reading.deviation[c] / mean) +
             " of its mean in " + image.channels[c]);
  }
  return reading;
}

ExposureRatio exposure_ratio(const CardReading& image, const CardReading& other) {
  if (image.mean.size() != other.mean.size())
    throw InvalidInput("gray card: both images must have as many channels, but have " +
                       std::to_string(image.mean.size()) + " and " +
                       std::to_string(other.mean.size()));
  constexpr double pixels_alike = 64.0;
  const auto relative = [](const CardReading& card, std::size_t c) {
    return card.deviation[c] / card.mean[c] *
           std::sqrt(std::min(1.0, pixels_alike / static_cast<double>(card.pixels)));
  };
  ExposureRatio ratio;
  for (std::size_t c = 0; c < image.mean.size(); ++c) {
    ratio.factor.push_back(other.mean[c] / image.mean[c]);
    ratio.deviation.push_back(std::hypot(relative(image, c), relative(other, c)));
  }
  return ratio;
}

std::vector<double> white_level(const CardReading& card, const std::vector<double>& reflectance) {
  if (reflectance.size() != 1 && reflectance.size() != card.mean.size())
    throw InvalidInput("gray card: reflectance must be one number or one for each of the " +
                       std::to_string(card.mean.size()) + " channels, but has " +
                       std::to_string(reflectance.size()));
  std::vector<double> level;
  for (std::size_t c = 0; c < card.mean.size(); ++c) {
    const double r = of_channel(reflectance, c);
    if (!(r > 0.0 && r <= 2.0))
      throw InvalidInput("gray card: reflectance must lie in (0, 2], but is " + number_text(r));
    level.push_back(card.mean[c] / r);
  }
  return level;
}

}  // namespace lamina
