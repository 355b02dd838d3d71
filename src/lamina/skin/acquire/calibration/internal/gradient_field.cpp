// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/internal/gradient_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lamina/base/core/parallel.h"
#include "lamina/base/image/resample.h"
#include "lamina/skin/acquire/calibration/internal/cubic_lookup.h"
#include "lamina/skin/acquire/calibration/internal/local_median.h"

namespace lamina {
namespace {

/// Differences of an image that is blurred by the binomial of order 8, of spread 1.4: narrower ones
/// leave noise that interpolation blurs, which draws registrations to halves of pixels.
constexpr int reach = 4;
constexpr std::array<float, 9> smooth = {1 / 256.0f,  8 / 256.0f,  28 / 256.0f,
                                         56 / 256.0f, 70 / 256.0f, 56 / 256.0f,
                                         28 / 256.0f, 8 / 256.0f,  1 / 256.0f};
constexpr std::array<float, 9> slope = {-1 / 128.0f, -6 / 128.0f, -14 / 128.0f, -14 / 128.0f, 0.0f,
                                        14 / 128.0f, 14 / 128.0f, 6 / 128.0f,   1 / 128.0f};

/// @param image  its first channel, and in the second how much of a pixel is used
GradientField make_gradient_field(const Image& image) {
  GradientField field{image.width, image.height, {}, {}};
  field.gradients.resize(image.pixels.size() / 2);
  field.weights.resize(field.gradients.size());
  if (std::min(image.width, image.height) <= 2 * reach) return field;
  parallel_for(static_cast<std::size_t>(image.height - 2 * reach), [&](std::size_t row) {
    const int y = static_cast<int>(row) + reach;
    for (int x = reach; x < image.width - reach; ++x) {
      Vec2f gradient{};
      float weight = 1.0f;
      for (int j = 0; j <= 2 * reach; ++j)
        for (int i = 0; i <= 2 * reach; ++i) {
          const float* pixel = image.at(x + i - reach, y + j - reach);
          const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
          gradient.x += slope[a] * smooth[b] * pixel[0];
          gradient.y += smooth[a] * slope[b] * pixel[0];
          weight = std::min(weight, pixel[1]);
        }
      field.gradients[field.index(x, y)] = gradient;
      field.weights[field.index(x, y)] = weight;
    }
  });
  std::vector<float> lengths;
  for (std::size_t i = 0; i < field.gradients.size(); ++i)
    if (field.weights[i] > 0.0f)
      lengths.push_back(std::hypot(field.gradients[i].x, field.gradients[i].y));
  const float median = lengths.empty() ? 0.0f : median_of(lengths);
  for (Vec2f& g : field.gradients) {
    const float length = std::sqrt(g.x * g.x + g.y * g.y + 4.0f * median * median);
    g = length > 0.0f ? (1.0f / length) * g : Vec2f{};
  }
  return field;
}

/// A channel without its unused pixels, and in a second one which pixels are used.
Image with_use(const Image& image, std::size_t channel, const PixelMask& mask) {
  constexpr int neighborhood = 24;
  Image result = make_image(image.width, image.height, {"value", "use"});
  bool all_used = true;
  PixelMask finite = mask;
  for (std::size_t i = 0; i < mask.faults.size(); ++i) {
    const float value = image.pixels[i * image.channel_count() + channel];
    if (!std::isfinite(value)) finite.mark(i, PixelFault::not_finite);
    result.pixels[2 * i] = value;
    result.pixels[2 * i + 1] = finite.faults[i] == 0 ? 1.0f : 0.0f;
    all_used = all_used && finite.faults[i] == 0;
  }
  if (all_used) return result;
  const Image nearby = local_median(result, finite, neighborhood);
  for (std::size_t i = 0; i < mask.faults.size(); ++i)
    if (finite.faults[i] != 0) result.pixels[2 * i] = nearby.pixels[2 * i];
  return result;
}

}  // namespace

std::vector<GradientField> gradient_pyramid(const Image& image, std::size_t channel,
                                            const PixelMask& mask) {
  constexpr int least_side = 32;
  std::vector<GradientField> fields;
  for (Image level = with_use(image, channel, mask);;) {
    fields.push_back(make_gradient_field(level));
    if (std::min(level.width, level.height) < 2 * least_side) return fields;
    level = resampled(level, level.width / 2, level.height / 2);
  }
}

GradientSample sample_gradient(const GradientField& field, Vec2 place) {
  const CubicLookup across = cubic_lookup(place.x), down = cubic_lookup(place.y);
  GradientSample sample;
  for (int j = 0; j < 4; ++j) {
    const auto b = static_cast<std::size_t>(j);
    const Vec2f* row = &field.gradients[field.index(across.first, down.first + j)];
    Vec2 value{}, slope_x{};
    for (std::size_t a = 0; a < 4; ++a) {
      const Vec2 g{static_cast<double>(row[a].x), static_cast<double>(row[a].y)};
      value = value + across.weights[a] * g;
      slope_x = slope_x + across.derivatives[a] * g;
    }
    sample.value = sample.value + down.weights[b] * value;
    sample.by_x = sample.by_x + down.weights[b] * slope_x;
    sample.by_y = sample.by_y + down.derivatives[b] * value;
  }
  return sample;
}

}  // namespace lamina
