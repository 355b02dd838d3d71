// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/base/image/image.h"
#include "lamina/render/film/camera_sample.h"
#include "lamina/render/film/film_pixel.h"

namespace lamina {

/// Sums of the samples of each pixel, exact: films that share the samples among them add up to what
/// one film of all samples holds, bit by bit. Pixels are independent: different ones may be added
/// to from different threads.
class FilmAccumulator {
 public:
  FilmAccumulator(int width, int height);

  void add(int x, int y, const CameraSample& sample);

  /// The means, with the channels that RenderResult lists.
  /// @param has_alpha  with A, the share of the samples that met a surface
  [[nodiscard]] Image image(bool has_alpha = false) const;

  [[nodiscard]] std::vector<PixelCover> covers() const;  ///< [y][x]

  [[nodiscard]] double mean_samples() const;
  [[nodiscard]] int least_samples() const;  ///< of all pixels

  struct Luminance {
    double mean = 0.0;
    double variance = 0.0;  ///< of the mean of a pixel, if its samples were independent
  };
  /// Averages over the pixels from (x0, y0) up to (x1, y1), which is not one of them.
  [[nodiscard]] Luminance luminance_of(int x0, int y0, int x1, int y1) const;

  [[nodiscard]] std::span<const FilmPixel> pixels() const { return pixels_; }  ///< [y][x]
  [[nodiscard]] std::span<FilmPixel> pixels() { return pixels_; }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// The state in memory, for a checkpoint of this program.
  [[nodiscard]] std::span<const std::byte> bytes() const {
    return std::as_bytes(std::span(pixels_));
  }

 private:
  int width_, height_;
  std::vector<FilmPixel> pixels_;
};

/// [y][x], whether a pixel tells of the noise: all its samples met a translucent surface or, if no
/// pixel is like that, any surface.
[[nodiscard]] std::vector<bool> measured_pixels(std::span<const PixelCover> covers);

}  // namespace lamina
