// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/image/image.h"

namespace lamina {

struct DenoiseOptions {
  int window = 8;         ///< pixels are averaged with those up to this far away [pixel]
  int patch = 3;          ///< and compared by squares of this half width [pixel]
  double strength = 0.5;  ///< differences of so many standard errors count as noise, > 0
};

/// A render with less noise: R, G and B become averages over pixels whose surroundings look alike
/// within their noise and that show alike surfaces. The render's own become noisy.R, .G and .B; all
/// other channels stay. It blurs what is fainter than the noise, and cuts fireflies, pixels whose
/// light is that of four samples at most and far above their surroundings, to what is around them:
/// so it is for viewing, not for measuring.
///
/// @param render  channels R, G, B and variance (of the mean luminance of a pixel); albedo.R, .G,
///                .B, normal.X, .Y, .Z and depth.Z guide it where there are.
/// @throws InvalidInput if R, G, B or variance are missing.
///
/// Source: non-local means [Buades2005] with the distance of [Rousselle2012], which takes the
/// variance of both pixels into account; the features are weighted as in joint bilateral filters.
[[nodiscard]] Image denoise(const Image& render, const DenoiseOptions& options = {});

}  // namespace lamina
