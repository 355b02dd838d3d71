// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/image/compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "lamina/core/error.h"
#include "lamina/core/number_text.h"

namespace lamina {
namespace {

void require_alike(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height)
    throw InvalidInput("images: both must have the same size, but are " + std::to_string(a.width) +
                       " x " + std::to_string(a.height) + " and " + std::to_string(b.width) +
                       " x " + std::to_string(b.height));
  if (a.channels != b.channels) throw InvalidInput("images: both must have the same channels");
}

double two_sided_p_value(double z) { return std::erfc(std::abs(z) / std::numbers::sqrt2); }

/// z of a difference whose variance may be 0.
double z_score(double difference, double variance) {
  if (difference == 0.0) return 0.0;
  return difference / std::sqrt(variance);  // infinite without variance
}

/// Luminance, or the first channel of images without R, G, B.
std::vector<double> brightness(const Image& image) {
  const auto r = channel_index(image, "R"), g = channel_index(image, "G"),
             b = channel_index(image, "B");
  std::vector<double> values;
  values.reserve(image.pixels.size() / std::max<std::size_t>(1, image.channel_count()));
  for (std::size_t at = 0; at < image.pixels.size(); at += image.channel_count()) {
    const auto channel = [&](std::size_t c) { return static_cast<double>(image.pixels[at + c]); };
    values.push_back(r && g && b
                         ? 0.2126 * channel(*r) + 0.7152 * channel(*g) + 0.0722 * channel(*b)
                         : channel(0));
  }
  return values;
}

}  // namespace

ImageComparison compare_renders(const RenderEstimate& a, const RenderEstimate& b,
                                double significance) {
  require_alike(a.mean, b.mean);
  require_alike(a.mean, a.variance);
  require_alike(b.mean, b.variance);
  const std::size_t count = a.mean.pixels.size(), channels = a.mean.channel_count();
  if (count == 0) throw InvalidInput("images: there are no pixels to compare");
  if (!(significance > 0.0 && significance < 1.0))
    throw InvalidInput("significance must lie in (0, 1), but is " + number_text(significance));

  ImageComparison result;
  result.threshold = 0.5 * significance / static_cast<double>(count);
  result.p_values = make_image(a.mean.width, a.mean.height, {"Y"});
  std::ranges::fill(result.p_values.pixels, 1.0f);
  double sum = 0.0, sum_variance = 0.0, sum_square_z = 0.0;
  std::size_t noisy = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double variance_a = static_cast<double>(a.variance.pixels[i]);
    const double variance_b = static_cast<double>(b.variance.pixels[i]);
    const double difference =
        static_cast<double>(a.mean.pixels[i]) - static_cast<double>(b.mean.pixels[i]);
    const double variance = variance_a + variance_b;
    if (!std::isfinite(difference) || !std::isfinite(variance) || variance_a < 0.0 ||
        variance_b < 0.0)
      throw InvalidInput(
          "images: means and variances must be finite, variances >= 0, but at pixel " +
          std::to_string(i / channels) + " one is not");
    const double z = z_score(difference, variance);
    const double p = two_sided_p_value(z);
    result.smallest_p_value = std::min(result.smallest_p_value, p);
    if (p < result.threshold) ++result.differing;
    float& pixel_p = result.p_values.pixels[i / channels];
    pixel_p = std::min(pixel_p, static_cast<float>(p));
    sum += difference;
    sum_variance += variance;
    if (variance > 0.0) {
      sum_square_z += z * z;
      ++noisy;
    }
  }
  result.bias_z = z_score(sum, sum_variance);
  result.mean_square_z = noisy > 0 ? sum_square_z / static_cast<double>(noisy) : 0.0;
  result.rmse = root_mean_square_difference(a.mean, b.mean);
  result.agrees = result.differing == 0 && two_sided_p_value(result.bias_z) >= 0.5 * significance;
  return result;
}

std::string ImageComparison::report() const {
  return printf_text(
      "%s: %zu pixel values differ (smallest p-value %.2g, threshold %.2g), bias %.2f "
      "standard errors, mean square z %.3f, rmse %.3g",
      agrees ? "agree" : "differ", differing, smallest_p_value, threshold, bias_z, mean_square_z,
      rmse);
}

double root_mean_square_difference(const Image& a, const Image& b) {
  require_alike(a, b);
  if (a.pixels.empty()) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const double difference = static_cast<double>(a.pixels[i]) - static_cast<double>(b.pixels[i]);
    sum += difference * difference;
  }
  return std::sqrt(sum / static_cast<double>(a.pixels.size()));
}

double relative_noise(const Image& image, const Image& mask) {
  if (image.width != mask.width || image.height != mask.height)
    throw InvalidInput("mask: its size must be that of the image");
  if (image.channels.empty() || mask.channels.empty())
    throw InvalidInput("images: at least one channel is required");
  const std::vector<double> values = brightness(image);
  const auto width = static_cast<std::size_t>(image.width);
  const auto counts = [&](std::size_t pixel) {
    return mask.pixels[pixel * mask.channel_count()] > 0.5f;
  };
  std::vector<double> residuals;
  for (std::size_t y = 1; y + 1 < static_cast<std::size_t>(image.height); ++y)
    for (std::size_t x = 1; x + 1 < width; ++x) {
      const std::size_t at = y * width + x;
      if (!(counts(at) && counts(at - 1) && counts(at + 1) && counts(at - width) &&
            counts(at + width)))
        continue;
      const double around =
          values[at - 1] + values[at + 1] + values[at - width] + values[at + width];
      const double patch = (around + values[at]) / 5.0;
      if (patch > 0.0) residuals.push_back(std::abs(values[at] - 0.25 * around) / patch);
    }
  if (residuals.empty()) return 0.0;
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::ranges::nth_element(residuals, middle);
  return *middle;
}

double relative_noise(const Image& image) {
  Image mask = make_image(image.width, image.height, {"Y"});
  std::ranges::fill(mask.pixels, 1.0f);
  return relative_noise(image, mask);
}

}  // namespace lamina
