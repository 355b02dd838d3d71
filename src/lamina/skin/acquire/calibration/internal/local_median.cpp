// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/internal/local_median.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lamina/base/core/parallel.h"
#include "lamina/base/image/bilinear.h"

namespace lamina {
namespace {

/// Of a channel over used pixels in [x0, x1) x [y0, y1).
float median_within(const Image& image, const PixelMask& mask, std::size_t channel, int x0, int y0,
                    int x1, int y1) {
  std::vector<float> values;
  for (int y = std::max(y0, 0); y < std::min(y1, image.height); ++y)
    for (int x = std::max(x0, 0); x < std::min(x1, image.width); ++x)
      if (mask.is_used(x, y)) values.push_back(image.at(x, y)[channel]);
  return median_of(values);
}

}  // namespace

float median_of(std::vector<float>& values) {
  if (values.empty()) return std::numeric_limits<float>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

Image local_median(const Image& image, const PixelMask& mask, int side) {
  const int cell = side / 3;
  Image coarse =
      make_image((image.width + cell - 1) / cell, (image.height + cell - 1) / cell, image.channels);
  const std::size_t channels = image.channel_count();
  std::vector<float> whole;
  for (std::size_t c = 0; c < channels; ++c)
    whole.push_back(median_within(image, mask, c, 0, 0, image.width, image.height));
  parallel_for(static_cast<std::size_t>(coarse.height), [&](std::size_t row) {
    const int y = static_cast<int>(row) * cell;
    for (int cx = 0; cx < coarse.width; ++cx) {
      const int x = cx * cell;
      for (std::size_t c = 0; c < channels; ++c) {
        const float median =
            median_within(image, mask, c, x - cell, y - cell, x + 2 * cell, y + 2 * cell);
        coarse.at(cx, static_cast<int>(row))[c] = std::isnan(median) ? whole[c] : median;
      }
    }
  });
  Image result = make_image(image.width, image.height, image.channels);
  parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t row) {
    const auto y = static_cast<int>(row);
    for (int x = 0; x < image.width; ++x) {
      const auto lookup = bilinear_clamped(
          (static_cast<float>(x) + 0.5f) / static_cast<float>(cell),
          (static_cast<float>(y) + 0.5f) / static_cast<float>(cell), coarse.width, coarse.height);
      for (std::size_t c = 0; c < channels; ++c)
        result.at(x, y)[c] = lookup.interpolate([&](int i, int j) { return coarse.at(i, j)[c]; });
    }
  });
  return result;
}

}  // namespace lamina
