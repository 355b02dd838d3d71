// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/objective/coarser_capture.h"

#include <cmath>
#include <limits>

#include "lamina/skin/acquire/inversion/objective/half_grid.h"

namespace lamina::detail {
namespace {

/// Calls take(coarse texel, its fine texels) for all.
template <class Take>
void for_fours(int width, int height, const Take& take) {
  const int coarse_width = (width + 1) / 2;
  for (int y = 0; y < (height + 1) / 2; ++y)
    for (int x = 0; x < coarse_width; ++x) {
      std::vector<std::size_t> fine;
      for (int s = 0; s < 4; ++s)
        if (2 * x + s % 2 < width && 2 * y + s / 2 < height)
          fine.push_back(static_cast<std::size_t>((2 * y + s / 2) * width + 2 * x + s % 2));
      take(static_cast<std::size_t>(y * coarse_width + x), fine);
    }
}

}  // namespace

PatchCapture coarser_capture(const PatchCapture& capture) {
  PatchCapture coarse = capture;
  coarse.width = (capture.width + 1) / 2;
  coarse.height = (capture.height + 1) / 2;
  coarse.mm_per_texel *= 2.0;
  for (std::size_t l = 0; l < capture.lights.size(); ++l) {
    coarse.lights[l] = make_plane(coarse.width, coarse.height);
    for_fours(capture.width, capture.height, [&](std::size_t to, const auto& fine) {
      float sum = 0.0f;
      for (const std::size_t t : fine) sum += capture.lights[l].values[t];
      coarse.lights[l].values[to] = sum / static_cast<float>(fine.size());
    });
  }
  for (std::size_t i = 0; i < capture.images.size(); ++i) {
    const PatchImage& from = capture.images[i];
    PatchImage& image = coarse.images[i];
    image.reflected = make_plane(coarse.width, coarse.height);
    image.deviation =
        make_plane(coarse.width, coarse.height, std::numeric_limits<float>::infinity());
    for_fours(capture.width, capture.height, [&](std::size_t to, const auto& fine) {
      double sum = 0.0, weights = 0.0;
      std::size_t known = 0;
      for (const std::size_t t : fine) {
        const auto deviation = static_cast<double>(from.deviation.values[t]);
        if (std::isinf(deviation)) continue;
        ++known;
        weights += 1.0 / (deviation * deviation);
        sum += static_cast<double>(from.reflected.values[t]) / (deviation * deviation);
      }
      if (2 * known < fine.size()) return;
      image.reflected.values[to] = static_cast<float>(sum / weights);
      image.deviation.values[to] = static_cast<float>(1.0 / std::sqrt(weights));
    });
  }
  return coarse;
}

TexelMaps on_finer(const TexelMaps& coarse, const PatchCapture& fine) {
  TexelMaps result(coarse.size());
  for (std::size_t n = 0; n < coarse.size(); ++n)
    result[n] = on_fine({fine.width, fine.height}, coarse[n]);
  return result;
}

}  // namespace lamina::detail
