// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "lamina/render/subsurface/random_walk/random_walk.h"

namespace lamina {

/// Means of estimates that are independent of one another.
struct WalkMeans {
  std::array<double, 3> mean{}, error{};  ///< [band]; the latter is the standard error
};

inline WalkMeans walk_means(const RandomWalk<4>& walk, const ExitPoint& exit,
                            const LightGatherer<4>& light) {
  constexpr int count = 4096;
  WalkMeans result;
  std::array<double, 3> squares{};
  for (std::uint32_t i = 0; i < count; ++i) {
    PixelSamples samples(11, i, 0);  // one of each pixel
    const BandValues<4> value = walk.leaving_radiance(exit, light, samples);
    for (std::size_t b = 0; b < 3; ++b) {
      const auto v = static_cast<double>(value[static_cast<int>(b)]);
      result.mean[b] += v / count;
      squares[b] += v * v / count;
    }
  }
  for (std::size_t b = 0; b < 3; ++b)
    result.error[b] = std::sqrt((squares[b] - result.mean[b] * result.mean[b]) / count);
  return result;
}

}  // namespace lamina
