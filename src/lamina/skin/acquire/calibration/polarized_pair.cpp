// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/polarized_pair.h"

#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/skin/acquire/calibration/internal/channel_values.h"

namespace lamina {

PolarizedPair separate_polarized(const Developed& parallel, const Developed& crossed,
                                 const PolarizedPairOptions& options) {
  require_like(crossed.reflectance, parallel.reflectance, "polarized pair: the crossed image");
  const double leak = options.leak;
  if (!(leak >= 0.0 && leak < 0.5))
    throw InvalidInput("polarized pair: leak must lie in [0, .5), but is " + number_text(leak));
  PolarizedPair pair{
      .diffuse = crossed, .specular = crossed.reflectance, .specular_deviation = crossed.deviation};
  Developed& diffuse = pair.diffuse;
  diffuse.mask = combined(parallel.mask, crossed.mask);
  const std::size_t channels = pair.specular.channel_count();
  diffuse.negative.assign(channels, 0);
  diffuse.far_negative.assign(channels, 0);
  const double over = 1.0 / (1.0 - 2.0 * leak);
  for (std::size_t i = 0; i < pair.specular.pixels.size(); ++i) {
    float *const d = &diffuse.reflectance.pixels[i], *const s = &pair.specular.pixels[i];
    float *const d_error = &diffuse.deviation.pixels[i], *const s_error =
                                                             &pair.specular_deviation.pixels[i];
    if (diffuse.mask.faults[i / channels] != 0) {
      *d = *s = *d_error = *s_error = 0.0f;
      continue;
    }
    const auto p = static_cast<double>(parallel.reflectance.pixels[i]);
    const auto c = static_cast<double>(crossed.reflectance.pixels[i]);
    const auto p_error = static_cast<double>(parallel.deviation.pixels[i]);
    const auto c_error = static_cast<double>(crossed.deviation.pixels[i]);
    // 2 (c - l s) with s = (p - c) / (1 - 2 l)
    const double value = 2.0 * over * ((1.0 - leak) * c - leak * p), mirrored = over * (p - c);
    const double error = 2.0 * over * std::hypot((1.0 - leak) * c_error, leak * p_error);
    *d = static_cast<float>(value);
    *d_error = static_cast<float>(error);
    *s = static_cast<float>(mirrored);
    *s_error = static_cast<float>(over * std::hypot(p_error, c_error));
    if (mirrored > options.most_specular) diffuse.mask.mark(i / channels, PixelFault::specular);
    if (value < 0.0) ++diffuse.negative[i % channels];
    if (value < -3.0 * error) ++diffuse.far_negative[i % channels];
  }
  require_used_pixels(diffuse.mask, "polarized pair: the mask");
  return pair;
}

}  // namespace lamina
