// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/develop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/skin/acquire/calibration/internal/channel_values.h"
#include "lamina/skin/acquire/calibration/internal/local_median.h"

namespace lamina {
namespace {

void check(const Photographs& photographs, const PixelMask& mask, const DevelopOptions& options) {
  const Image& raw = photographs.raw;
  require_size(mask, raw, "develop: the mask");
  require_like(photographs.white, raw, "develop: the white image");
  if (photographs.dark) require_like(*photographs.dark, raw, "develop: the dark image");
  require_one_or_each(options.white_reflectance, raw, "develop: white_reflectance");
  require_one_or_each(options.exposure_ratio, raw, "develop: exposure_ratio");
  const auto require = [](bool holds, const std::string& rule, double given) {
    if (!holds) throw InvalidInput("develop: " + rule + ", but is " + number_text(given));
  };
  for (const double r : options.white_reflectance)
    require(r > 0.0 && r <= 2.0, "white_reflectance must lie in (0, 2]", r);
  for (const double ratio : options.exposure_ratio)
    require(ratio > 0.0, "exposure_ratio must be > 0", ratio);
  require(photographs.white_count >= 1, "white_count must be >= 1", photographs.white_count);
  require(photographs.dark_count >= 1, "dark_count must be >= 1", photographs.dark_count);
  require(std::isfinite(photographs.black), "black must be finite", photographs.black);
  require(options.darkest_white > 0.0 && options.darkest_white < 1.0,
          "darkest_white must lie in (0, 1)", options.darkest_white);
  if (options.saturation)
    require(*options.saturation > photographs.black, "saturation must be above black",
            *options.saturation);
  if (!options.noise.empty() && options.noise.size() != raw.channel_count())
    throw InvalidInput("develop: noise must be given for each of the " +
                       std::to_string(raw.channel_count()) + " channels, but is for " +
                       std::to_string(options.noise.size()));
}

/// The median over the used pixels of each channel; NaN without one.
std::vector<double> medians(const Image& image, const PixelMask& mask) {
  const std::size_t channels = image.channel_count();
  std::vector<double> result;
  std::vector<float> values;
  for (std::size_t c = 0; c < channels; ++c) {
    values.clear();
    for (std::size_t i = 0; i < mask.faults.size(); ++i)
      if (mask.faults[i] == 0) values.push_back(image.pixels[i * channels + c]);
    result.push_back(static_cast<double>(median_of(values)));
  }
  return result;
}

void mark_saturated(PixelMask& mask, const Image& image, double saturation) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    if (static_cast<double>(image.pixels[i]) >= saturation)
      mask.mark(i / image.channel_count(), PixelFault::saturated);
}

/// The noise of an image, whose pixels have a pattern that the dark image shows, too.
std::vector<SensorNoise> noise_without_pattern(Image raw, const Image& dark, int dark_count,
                                               const PixelMask& mask) {
  for (std::size_t i = 0; i < raw.pixels.size(); ++i) raw.pixels[i] -= dark.pixels[i];
  std::vector<SensorNoise> noise = estimate_noise(raw, mask);
  const std::vector<double> black = medians(dark, mask);
  for (std::size_t c = 0; c < noise.size(); ++c) {
    noise[c].black = black[c];
    noise[c].read_variance /= 1.0 + 1.0 / dark_count;  // both images are read out
  }
  return noise;
}

/// Numbers of a place in the three images, the variance of each, and the factor of their ratio.
struct Place {
  double raw, white, dark;
  double raw_variance, white_variance, dark_variance;
  double factor;
};

struct Reflectance {
  double value, deviation;
};

/// To first order in the errors; the derivative by the dark is (raw - white) / (white - dark)^2.
Reflectance reflectance_of(const Place& p) {
  const double light = p.white - p.dark, ratio = (p.raw - p.dark) / light;
  const double variance = (p.raw_variance + ratio * ratio * p.white_variance +
                           (ratio - 1.0) * (ratio - 1.0) * p.dark_variance) /
                          (light * light);
  return {p.factor * ratio, p.factor * std::sqrt(variance)};
}

}  // namespace

double find_saturation(const Image& image) {
  const std::size_t channels = image.channel_count();
  std::vector<bool> varies(channels);
  for (std::size_t i = channels; i < image.pixels.size(); ++i)
    if (image.pixels[i] != image.pixels[i % channels]) varies[i % channels] = true;
  const auto for_numbers = [&](const auto& body) {
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      if (varies[i % channels] && std::isfinite(image.pixels[i])) body(image.pixels[i]);
  };
  float largest = 0.0f;
  for_numbers([&](float v) { largest = std::max(largest, v); });
  const float near = 0.98f * largest;
  std::ptrdiff_t at_top = 0, below = 0;
  for_numbers([&](float v) {
    at_top += v == largest ? 1 : 0;
    below += v >= near && v < largest ? 1 : 0;
  });
  const bool is_end = largest == 1.0f || (largest > 0.0f && at_top >= 8 && at_top > below);
  return is_end ? static_cast<double>(near) : std::numeric_limits<double>::infinity();
}

Developed develop(const Photographs& photographs, const PixelMask& mask,
                  const DevelopOptions& options) {
  check(photographs, mask, options);
  const auto& [raw, white, dark, white_count, dark_count, black] = photographs;
  const std::size_t channels = raw.channel_count();
  Developed result{.mask = mask, .noise = options.noise};
  mark_not_finite(result.mask, raw);
  mark_not_finite(result.mask, white);
  if (dark) mark_not_finite(result.mask, *dark);
  result.saturation =
      options.saturation.value_or(std::min(find_saturation(raw), find_saturation(white)));
  mark_saturated(result.mask, raw, result.saturation);
  mark_saturated(result.mask, white, result.saturation);
  require_used_pixels(result.mask, "develop: the mask");

  const auto dark_at = [&](std::size_t i) {
    return dark ? static_cast<double>(dark->pixels[i]) : black;
  };
  std::vector<double> brightest(channels);
  for (std::size_t i = 0; i < white.pixels.size(); ++i)
    if (result.mask.faults[i / channels] == 0)
      brightest[i % channels] =
          std::max(brightest[i % channels], static_cast<double>(white.pixels[i]) - dark_at(i));
  for (std::size_t i = 0; i < white.pixels.size(); ++i)
    if (!(static_cast<double>(white.pixels[i]) - dark_at(i) >
          options.darkest_white * brightest[i % channels]))
      result.mask.mark(i / channels, PixelFault::dark_white);
  require_used_pixels(result.mask, "develop: the mask");
  if (result.noise.empty())
    result.noise = dark ? noise_without_pattern(raw, *dark, dark_count, result.mask)
                        : estimate_noise(raw, result.mask, {black});

  result.reflectance = make_image(raw.width, raw.height, raw.channels);
  result.deviation = result.reflectance;
  result.negative.resize(channels);
  result.far_negative.resize(channels);
  for (std::size_t i = 0; i < raw.pixels.size(); ++i) {
    if (result.mask.faults[i / channels] != 0) continue;
    const std::size_t c = i % channels;
    const SensorNoise& noise = result.noise[c];
    const double r = static_cast<double>(raw.pixels[i]), w = static_cast<double>(white.pixels[i]);
    const double d = dark_at(i);
    const Reflectance reflectance =
        reflectance_of({.raw = r,
                        .white = w,
                        .dark = d,
                        .raw_variance = noise.variance(r),
                        .white_variance = noise.variance(w) / white_count,
                        .dark_variance = dark ? noise.variance(d) / dark_count : 0.0,
                        .factor = of_channel(options.white_reflectance, c) *
                                  of_channel(options.exposure_ratio, c)});
    result.reflectance.pixels[i] = static_cast<float>(reflectance.value);
    result.deviation.pixels[i] = static_cast<float>(reflectance.deviation);
    if (reflectance.value < 0.0) ++result.negative[c];
    if (reflectance.value < -3.0 * reflectance.deviation) ++result.far_negative[c];
  }
  return result;
}

void mark_specular(Developed& image, const SpecularOptions& options) {
  const auto& [least_excess, least_deviations, neighborhood] = options;
  if (!(least_excess > 0.0) || !(least_deviations >= 0.0) || neighborhood < 8)
    throw InvalidInput(
        "specular: least_excess must be > 0, least_deviations >= 0, and the "
        "neighborhood >= 8 pixels, but they are " +
        number_text(least_excess) + ", " + number_text(least_deviations) + " and " +
        std::to_string(neighborhood));
  const Image nearby = local_median(image.reflectance, image.mask, neighborhood);
  const std::size_t channels = nearby.channel_count();
  for (std::size_t pixel = 0; pixel < image.mask.faults.size(); ++pixel) {
    if (image.mask.faults[pixel] != 0) continue;
    bool exceeds = true;
    for (std::size_t i = pixel * channels; i < (pixel + 1) * channels; ++i) {
      const auto excess = static_cast<double>(image.reflectance.pixels[i] - nearby.pixels[i]);
      exceeds = exceeds && excess > least_excess &&
                excess > least_deviations * static_cast<double>(image.deviation.pixels[i]);
    }
    if (!exceeds) continue;
    image.mask.mark(pixel, PixelFault::specular);
  }
}

}  // namespace lamina
