// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lamina/image/image.h"
#include "lamina/render/path_tracer.h"

namespace lamina {

/// Sums of the samples of each pixel. Pixels are independent: different ones may be added to from
/// different threads.
class FilmAccumulator {
 public:
  FilmAccumulator(int width, int height);

  void add(int x, int y, const CameraSample& sample);

  /// The means, with the channels that RenderResult lists.
  [[nodiscard]] Image image() const;

  /// [y][x], whether all samples of a pixel met a translucent surface.
  [[nodiscard]] std::vector<bool> subsurface_pixels() const;

  [[nodiscard]] double mean_samples() const;

 private:
  struct Pixel {
    Vec3f beauty, subsurface, specular, normal, albedo;
    float depth = 0.0f;
    float luminance_mean = 0.0f, luminance_spread = 0.0f;  ///< Welford's running mean and sum
    int samples = 0, hits = 0, subsurface_hits = 0;
  };
  int width_, height_;
  std::vector<Pixel> pixels_;
};

}  // namespace lamina
