// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/blur.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lamina/base/image/resample.h"

namespace lamina {
namespace {

constexpr double widest_direct = 6.0;  // spread of a blur on the grid of the image [texel]
constexpr double coarse_spread = 3.0;  // of one on a coarser grid, at least [its texel]

/// A blur of each channel by the sum over texels.
Image blurred_directly(const Image& image, double spread) {
  Image result = image;
  const std::size_t channels = image.channel_count(), texels = image.pixels.size() / channels;
  std::vector<float> plane(texels);
  for (std::size_t c = 0; c < channels; ++c) {
    for (std::size_t i = 0; i < texels; ++i) plane[i] = image.pixels[i * channels + c];
    plane = blurred(plane, image.width, image.height, spread);
    for (std::size_t i = 0; i < texels; ++i) result.pixels[i * channels + c] = plane[i];
  }
  return result;
}

}  // namespace

std::size_t mirrored_index(int i, int length) {
  i %= 2 * length;
  if (i < 0) i += 2 * length;
  return static_cast<std::size_t>(i < length ? i : 2 * length - 1 - i);
}

std::vector<float> blurred(const std::vector<float>& image, int width, int height, double spread) {
  const int reach = static_cast<int>(std::ceil(3.0 * spread));
  std::vector<float> taps;
  for (int i = -reach; i <= reach; ++i)
    taps.push_back(static_cast<float>(std::exp(-0.5 * i * i / (spread * spread))));
  const float sum = std::accumulate(taps.begin(), taps.end(), 0.0f);
  /// Along one side of the image, whose texels are `stride` apart in lines that are `next` apart.
  const auto pass = [&](const std::vector<float>& from, int length, int lines, int stride,
                        int next) {
    std::vector<float> to(from.size());
    std::vector<float> line(static_cast<std::size_t>(length + 2 * reach));
    for (int l = 0; l < lines; ++l) {
      const auto at = [&](std::size_t i) {
        return static_cast<std::size_t>(l * next) + i * static_cast<std::size_t>(stride);
      };
      for (int i = -reach; i < length + reach; ++i)
        line[static_cast<std::size_t>(i + reach)] = from[at(mirrored_index(i, length))];
      for (int i = 0; i < length; ++i)
        to[at(static_cast<std::size_t>(i))] =
            std::inner_product(taps.begin(), taps.end(), line.begin() + i, 0.0f) / sum;
    }
    return to;
  };
  return pass(pass(image, width, height, 1, width), height, width, width, 1);
}

Image blurred(const Image& image, double spread) {
  if (!(spread > 0.0)) return image;
  if (spread <= widest_direct) return blurred_directly(image, spread);
  // A side becomes a whole number of coarse texels, so its factor differs a little from the other.
  // Wider than the image there is one texel, its mean.
  const double factor = spread / coarse_spread;
  const auto side = [&](int length) {
    return std::max(1, static_cast<int>(std::lround(length / factor)));
  };
  const Image coarse = resampled(image, side(image.width), side(image.height));
  // Each tent, down and up, has a variance of a sixth of a coarse texel's square.
  const double left = std::sqrt(coarse_spread * coarse_spread - 2.0 / 6.0);
  return resampled(blurred_directly(coarse, left), image.width, image.height);
}

}  // namespace lamina
