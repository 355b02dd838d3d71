// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/resample.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace lamina {
namespace {

/// The old texels that a new one is made of.
struct Share {
  int first;
  std::vector<float> weights;
};

std::vector<Share> shares(int from, int to) {
  const double scale = static_cast<double>(from) / to, reach = std::max(scale, 1.0);
  std::vector<Share> result;
  for (int i = 0; i < to; ++i) {
    const double centre = (i + 0.5) * scale - 0.5;  // in old texels
    const int first = std::max(0, static_cast<int>(std::ceil(centre - reach)));
    const int last = std::min(from - 1, static_cast<int>(std::floor(centre + reach)));
    std::vector<double> weights;
    double sum = 0.0;
    for (int j = first; j <= last; ++j) {
      weights.push_back(std::max(0.0, 1.0 - std::abs(j - centre) / reach));
      sum += weights.back();
    }
    Share share{first, {}};
    for (const double weight : weights) share.weights.push_back(static_cast<float>(weight / sum));
    result.push_back(std::move(share));
  }
  return result;
}

}  // namespace

Image resampled(const Image& image, int width, int height) {
  assert(width > 0 && height > 0 && image.width > 0 && image.height > 0);
  const std::size_t channels = image.channel_count();
  Image wide = make_image(width, image.height, image.channels);
  const std::vector<Share> across = shares(image.width, width), down = shares(image.height, height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto& [first, weights] = across[static_cast<std::size_t>(x)];
      for (std::size_t j = 0; j < weights.size(); ++j)
        for (std::size_t c = 0; c < channels; ++c)
          wide.at(x, y)[c] += weights[j] * image.at(first + static_cast<int>(j), y)[c];
    }
  Image result = make_image(width, height, image.channels);
  for (int y = 0; y < height; ++y) {
    const auto& [first, weights] = down[static_cast<std::size_t>(y)];
    for (std::size_t j = 0; j < weights.size(); ++j) {
      const float* from = wide.at(0, first + static_cast<int>(j));
      float* to = result.at(0, y);
      for (std::size_t i = 0; i < static_cast<std::size_t>(width) * channels; ++i)
        to[i] += weights[j] * from[i];
    }
  }
  return result;
}

}  // namespace lamina
