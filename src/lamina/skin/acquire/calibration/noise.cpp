// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/noise.h"

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/skin/acquire/calibration/internal/channel_values.h"
#include "lamina/skin/acquire/calibration/internal/chi_squared.h"

namespace lamina {
namespace {

constexpr int block_side = 8;
constexpr int most_classes = 24, least_blocks = 16;

/// A block of pixels, or a class of blocks.
struct Brightness {
  double mean = 0.0, variance = 0.0;
};

/// Mean and variance of a used block; absent if a pixel of it is not used, or no number.
/// @param contrast  of a cell of 2 x 2 pixels at (x, y), of the variance of one pixel
template <class Mean, class Contrast>
std::optional<Brightness> measured_block(const PixelMask& mask, int x0, int y0, const Mean& value,
                                         const Contrast& contrast) {
  Brightness block;
  constexpr double pixels = block_side * block_side;
  for (int y = y0; y < y0 + block_side; ++y)
    for (int x = x0; x < x0 + block_side; ++x) {
      if (!mask.is_used(x, y)) return std::nullopt;
      block.mean += value(x, y) / pixels;
      if (x % 2 == 0 && y % 2 == 0) {
        const double c = contrast(x, y);
        block.variance += c * c * 4.0 / pixels;
      }
    }
  if (!std::isfinite(block.mean)) return std::nullopt;
  return block;
}

/// Blocks that are alike bright, ordered by their variance.
struct BrightnessClass {
  double mean = 0.0;
  std::vector<double> variances;
};

std::vector<BrightnessClass> classes_of(std::vector<Brightness> blocks) {
  std::ranges::sort(blocks, {}, &Brightness::mean);
  const std::size_t count = std::min<std::size_t>(most_classes, blocks.size() / (least_blocks / 2));
  std::vector<BrightnessClass> classes(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t begin = i * blocks.size() / count, end = (i + 1) * blocks.size() / count;
    for (std::size_t j = begin; j < end; ++j) {
      classes[i].mean += blocks[j].mean / static_cast<double>(end - begin);
      classes[i].variances.push_back(blocks[j].variance);
    }
    std::ranges::sort(classes[i].variances);
  }
  return classes;
}

constexpr double degrees_of_block = block_side * block_side / 4.0;

/// The variance of each class by the lower quartile of those of its blocks that are smooth.
std::vector<Brightness> smooth_classes(std::span<const BrightnessClass> classes, double smooth) {
  constexpr double normal_of_quartile = -0.67449;
  const double quartile = chi_squared_quantile(degrees_of_block, normal_of_quartile);
  std::vector<Brightness> result;
  for (const auto& [mean, variances] : classes) {
    const double place = 0.25 * smooth * static_cast<double>(variances.size()) - 0.5;
    const auto low = static_cast<std::size_t>(std::max(0.0, place));
    const std::size_t high = std::min(low + 1, variances.size() - 1);
    const double part = std::max(0.0, place) - static_cast<double>(low);
    result.push_back({mean, std::lerp(variances[low], variances[high], part) / quartile});
  }
  return result;
}

/// The share of blocks that are smooth: twice that of those below their median, at least .1.
double smooth_share(std::span<const BrightnessClass> classes, const SensorNoise& noise) {
  const double median = chi_squared_quantile(degrees_of_block, 0.0);
  double below = 0.0, all = 0.0;
  for (const auto& [mean, variances] : classes) {
    const auto end = std::ranges::upper_bound(variances, median * noise.variance(mean));
    below += static_cast<double>(end - variances.begin());
    all += static_cast<double>(variances.size());
  }
  return std::clamp(2.0 * below / all, 0.1, 1.0);
}

/// The line of least squares, relative to itself, that is nowhere below 0.
SensorNoise fitted_line(std::span<const Brightness> classes, double black) {
  SensorNoise noise{.black = black};
  for (const Brightness& each : classes)
    noise.read_variance += each.variance / static_cast<double>(classes.size());
  for (int i = 0; i < 20; ++i) {
    double w = 0.0, ws = 0.0, wss = 0.0, wv = 0.0, wsv = 0.0;
    for (const Brightness& each : classes) {
      const double expected = noise.variance(each.mean);
      if (!(expected > 0.0)) continue;  // all of it is 0: no noise
      const double weight = 1.0 / (expected * expected), s = std::max(0.0, each.mean - black);
      w += weight, ws += weight * s, wss += weight * s * s;
      wv += weight * each.variance, wsv += weight * s * each.variance;
    }
    if (!(w > 0.0)) return noise;
    const double determinant = w * wss - ws * ws;
    const bool is_told = determinant > 1e-9 * w * wss;
    const double gain = is_told ? (w * wsv - ws * wv) / determinant : 0.0;
    const double read = is_told ? (wss * wv - ws * wsv) / determinant : wv / w;
    noise.gain = read < 0.0 && wss > 0.0 ? wsv / wss : std::max(0.0, gain);
    noise.read_variance = gain < 0.0 ? wv / w : std::max(0.0, read);
  }
  return noise;
}

template <class Value, class Contrast>
SensorNoise noise_of(const PixelMask& mask, double black, const Value& value,
                     const Contrast& contrast) {
  std::vector<Brightness> blocks;
  for (int y = 0; y + block_side <= mask.height; y += block_side)
    for (int x = 0; x + block_side <= mask.width; x += block_side)
      if (const auto block = measured_block(mask, x, y, value, contrast)) blocks.push_back(*block);
  if (blocks.size() < least_blocks)
    throw InvalidInput(
        "noise: at least 16 blocks of 8 x 8 used pixels are required, but there are " +
        std::to_string(blocks.size()));
  const std::vector<BrightnessClass> classes = classes_of(std::move(blocks));
  SensorNoise noise;
  double smooth = 1.0;
  for (int i = 0; i < 40; ++i) {
    noise = fitted_line(smooth_classes(classes, smooth), black);
    smooth = smooth_share(classes, noise);
  }
  return noise;
}

}  // namespace

std::vector<SensorNoise> estimate_noise(const Image& image, const PixelMask& mask,
                                        const std::vector<double>& black) {
  require_size(mask, image, "noise: the mask");
  require_one_or_each(black, image, "noise: black");
  std::vector<SensorNoise> noise;
  for (std::size_t c = 0; c < image.channel_count(); ++c) {
    const auto value = [&](int x, int y) { return static_cast<double>(image.at(x, y)[c]); };
    const auto contrast = [&](int x, int y) {
      return 0.5 * (value(x, y) - value(x + 1, y) - value(x, y + 1) + value(x + 1, y + 1));
    };
    noise.push_back(noise_of(mask, of_channel(black, c), value, contrast));
  }
  return noise;
}

std::vector<SensorNoise> estimate_noise(const Image& first, const Image& second,
                                        const PixelMask& mask, const std::vector<double>& black) {
  require_size(mask, first, "noise: the mask");
  require_like(second, first, "noise: the second image");
  require_one_or_each(black, first, "noise: black");
  std::vector<SensorNoise> noise;
  for (std::size_t c = 0; c < first.channel_count(); ++c) {
    const auto value = [&](int x, int y) {
      return 0.5 * static_cast<double>(first.at(x, y)[c] + second.at(x, y)[c]);
    };
    const auto difference = [&](int x, int y) {
      return static_cast<double>(first.at(x, y)[c] - second.at(x, y)[c]) / std::sqrt(2.0);
    };
    const auto contrast = [&](int x, int y) {
      return 0.5 * (difference(x, y) - difference(x + 1, y) - difference(x, y + 1) +
                    difference(x + 1, y + 1));
    };
    noise.push_back(noise_of(mask, of_channel(black, c), value, contrast));
  }
  return noise;
}

}  // namespace lamina
