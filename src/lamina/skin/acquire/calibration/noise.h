// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "lamina/base/image/image.h"
#include "lamina/skin/acquire/calibration/pixel_mask.h"

namespace lamina {

/// The noise of a sensor in one channel: its variance is that of reading it out, and of the
/// photons, which grows with the light. Source: [Janesick2007] §5, photon transfer.
struct SensorNoise {
  double read_variance = 0.0;  ///< in the square of the image's numbers
  double gain = 0.0;           ///< variance per number: that of one photon that is counted
  double black = 0.0;          ///< the number of no light

  /// At a number of the image.
  [[nodiscard]] double variance(double value) const {
    return read_variance + gain * std::max(0.0, value - black);
  }
};

/// The noise of each channel, from one image of a scene whose parts are smooth.
///
/// In cells of 2 x 2 pixels a - b - c + d has the variance of four pixels, whatever slope the scene
/// has. The mean of its square in a block of 8 x 8 pixels that is smooth follows a chi-squared law.
/// In classes of equal brightness the lower quartile of the smooth blocks gives the variance,
/// and a line of least relative squares through the classes is the noise. How many blocks are
/// smooth: as many again as lie below the median of that law, by repetition.
///
/// Within 10 % where half of the blocks are smooth (tests). Too high where few are, as in hair;
/// too low where the camera has smoothed the noise: JPEG, demosaiced colors, images that have
/// been resized. Two images tell it better.
///
/// @param black  the number of no light, for each channel or one for all
/// @throws InvalidInput if fewer than 16 whole blocks are used.
[[nodiscard]] std::vector<SensorNoise> estimate_noise(const Image& image, const PixelMask& mask,
                                                      const std::vector<double>& black = {0.0});

/// Estimates noise from two images of one scene, which has not moved, by their difference: whatever
/// the scene is like. A change of brightness between both is no noise.
[[nodiscard]] std::vector<SensorNoise> estimate_noise(const Image& first, const Image& second,
                                                      const PixelMask& mask,
                                                      const std::vector<double>& black = {0.0});

}  // namespace lamina
