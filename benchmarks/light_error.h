// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "lamina/base/image/image.h"

namespace lamina {

/// The light from below surfaces of a picture: its channels subsurface.R, .G, .B.
[[nodiscard]] inline Image subsurface_light(const Image& image) {
  return select_channels(image, {"subsurface.R", "subsurface.G", "subsurface.B"});
}

/// How wrong a picture's light is; all over the mean of the reference.
struct LightError {
  double rms = 0.0;        ///< root mean square difference from a reference without noise
  double rms_known = 0.0;  ///< standard error of rms², in the same unit: below it rms says nothing
  double mean = 0.0;       ///< mean of the picture over that of the reference, less 1
  double noise = 0.0;      ///< of one picture, root mean square
  double reference_noise = 0.0;  ///< of the mean of both halves
  std::size_t pixels = 0;        ///< that have light in both halves of the reference
};

/// Error of two pictures of equal expectation, a1 and a2, against a reference of two halves of
/// equal expectation, p and q, all with noise of their own; R, G and B. With b = (p + q) / 2 the
/// mean of (a - b)² holds the noise of b as well, of which (p - q)² / 4 is an unbiased estimate.
///
/// All are images of three channels and of one size.
[[nodiscard]] inline std::array<LightError, 3> light_error(const Image& a1, const Image& a2,
                                                           const Image& p, const Image& q) {
  std::array<LightError, 3> errors;
  for (std::size_t c = 0; c < 3; ++c) {
    double mean_a = 0, mean_b = 0, square = 0, square2 = 0, noise_a = 0, noise_b = 0, n = 0;
    for (std::size_t i = c; i < p.pixels.size(); i += 3) {
      const double x = a1.pixels[i], y = a2.pixels[i], u = p.pixels[i], v = q.pixels[i];
      if (!(u > 0.0 && v > 0.0)) continue;
      const double b = (u + v) / 2.0, noise = (u - v) * (u - v) / 4.0;
      const double error = ((x - b) * (x - b) + (y - b) * (y - b)) / 2.0 - noise;
      mean_a += (x + y) / 2.0;
      mean_b += b;
      square += error;
      square2 += error * error;
      noise_a += (x - y) * (x - y) / 2.0;
      noise_b += noise;
      n += 1.0;
    }
    if (n == 0.0) continue;
    const double scale = mean_b / n;
    const double variance = std::max(0.0, square2 / n - square / n * (square / n)) / n;
    errors[c] = {.rms = std::sqrt(std::max(0.0, square / n)) / scale,
                 .rms_known = std::sqrt(std::sqrt(variance)) / scale,
                 .mean = mean_a / mean_b - 1.0,
                 .noise = std::sqrt(noise_a / n) / scale,
                 .reference_noise = std::sqrt(noise_b / n) / scale,
                 .pixels = static_cast<std::size_t>(n)};
  }
  return errors;
}

}  // namespace lamina
