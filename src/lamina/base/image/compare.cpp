// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/spectrum/color.h"

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

/// A lit pixel against its four neighbours.
struct Residual {
  double mean;        ///< of the neighbours
  double difference;  ///< of the pixel from it
  double variance;    ///< that noise gives the difference; 0 where it is not known
};

/// Of the pixels that are measured, with their neighbours: those whose mean is at least a quarter
/// of the average.
std::vector<Residual> lit_residuals(const Image& image, const std::vector<bool>& is_measured) {
  const int w = image.width, h = image.height;
  const std::size_t pixels = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
  if (is_measured.size() != pixels)
    throw InvalidInput("relative_noise: an image of " + std::to_string(pixels) + " pixels, " +
                       std::to_string(is_measured.size()) + " marks");
  const auto value = [&](int x, int y) {
    const float* p = image.at(x, y);
    return static_cast<double>(image.channel_count() < 3 ? p[0] : luminance({p[0], p[1], p[2]}));
  };
  const auto place = channel_index(image, "variance");
  const auto variance = [&](int x, int y) {
    return place ? static_cast<double>(image.at(x, y)[*place]) : 0.0;
  };
  const auto is_inside = [&](int x, int y) {
    return is_measured[static_cast<std::size_t>(y) * static_cast<std::size_t>(w) +
                       static_cast<std::size_t>(x)];
  };
  const auto of_neighbours = [](const auto& f, int x, int y) {
    return f(x - 1, y) + f(x + 1, y) + f(x, y - 1) + f(x, y + 1);
  };
  std::vector<Residual> residuals;
  double total = 0.0;
  for (int y = 1; y + 1 < h; ++y)
    for (int x = 1; x + 1 < w; ++x) {
      if (!(is_inside(x, y) && is_inside(x - 1, y) && is_inside(x + 1, y) && is_inside(x, y - 1) &&
            is_inside(x, y + 1)))
        continue;
      const double mean = 0.25 * of_neighbours(value, x, y);
      if (!(mean > 0.0)) continue;
      residuals.push_back(
          {mean, value(x, y) - mean, variance(x, y) + of_neighbours(variance, x, y) / 16.0});
      total += mean;
    }
  const double threshold =
      0.25 * total / static_cast<double>(std::max<std::size_t>(residuals.size(), 1));
  std::erase_if(residuals, [&](const Residual& r) { return r.mean < threshold; });
  return residuals;
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

std::optional<double> relative_noise(const Image& image, const std::vector<bool>& is_measured) {
  std::vector<Residual> residuals = lit_residuals(image, is_measured);
  if (residuals.empty()) return std::nullopt;
  const auto relative = [](const Residual& r) { return std::abs(r.difference) / r.mean; };
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::ranges::nth_element(residuals, middle, {}, relative);
  return relative(*middle);
}

std::optional<double> relative_noise_rms(const Image& image, const std::vector<bool>& is_measured) {
  const std::vector<Residual> residuals = lit_residuals(image, is_measured);
  double sum = 0.0;
  bool is_known = false;
  for (const Residual& r : residuals) {
    is_known = is_known || r.variance > 0.0;
    sum += std::min(r.difference * r.difference, 9.0 * r.variance) / (r.mean * r.mean);
  }
  if (!is_known) return std::nullopt;
  return std::sqrt(sum / (1.25 * static_cast<double>(residuals.size())));
}

}  // namespace lamina
