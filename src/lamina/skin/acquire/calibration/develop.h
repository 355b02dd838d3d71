// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "lamina/base/image/image.h"
#include "lamina/skin/acquire/calibration/noise.h"
#include "lamina/skin/acquire/calibration/pixel_mask.h"

namespace lamina {

/// Photographs of one camera and light, linear, in the same numbers. All have the size and channels
/// of `raw`.
struct Photographs {
  Image raw;                            ///< of the skin
  Image white;                          ///< of a white reference that fills the image
  std::optional<Image> dark;            ///< without light; absent: no light is the number `black`
  int white_count = 1, dark_count = 1;  ///< photographs that they are the means of
  double black = 0.0;                   ///< where there is no dark image
};

/// Numbers are one for all channels, or one for each.
struct DevelopOptions {
  /// Reflectance of the white reference, in (0, 2]: .99 of pressed PTFE, .9 of a white card.
  std::vector<double> white_reflectance = {1.0};
  /// Exposure of the white image over that of the raw one: time times ISO over the f-number's
  /// square; > 0.
  std::vector<double> exposure_ratio = {1.0};
  /// Numbers from this on are saturated; absent: found, as find_saturation says.
  std::optional<double> saturation;
  /// Pixels whose white, less the dark, is less than this share of the brightest are not used, in
  /// (0, 1): in corners, noise of the white is more than that of the image.
  double darkest_white = 0.05;
  /// The noise of the raw image in each channel; empty: estimated from it.
  std::vector<SensorNoise> noise;
};

/// Reflectances, with what is known of their errors.
struct Developed {
  Image reflectance;  ///< of a surface lit and seen like the white reference
  Image deviation;    ///< standard deviation of each number
  PixelMask mask;     ///< what is not used has reflectance and deviation 0
  std::vector<SensorNoise> noise;
  double saturation = std::numeric_limits<double>::infinity();
  /// Used pixels below 0, and below -3 standard deviations, in each channel. The former are noise
  /// of dark pixels, the latter an error: of the dark image, or of stray light in it.
  std::vector<std::size_t> negative, far_negative;
};

/// R = white_reflectance * exposure_ratio * (raw - dark) / (white - dark), and its deviation: by
/// the noise of the sensor in all three images, of which the dark one counts in both differences.
///
/// @param mask  pixels to use.
/// @throws InvalidInput for images of different sizes or channels, numbers out of range, and if no
///         pixel is left, with the reasons.
[[nodiscard]] Developed develop(const Photographs& photographs, const PixelMask& mask,
                                const DevelopOptions& options = {});

/// Where a sensor ends: 98 % of the largest number, if numbers pile up there (8 of them, and more
/// than in the 2 % below), or if one is 1, the largest that integers can be. Infinite if nothing is
/// at an end. Channels of one number everywhere do not count: they are no photographs.
[[nodiscard]] double find_saturation(const Image& image);

struct SpecularOptions {
  double least_excess = 0.03;     ///< of reflectance in all channels; > 0
  double least_deviations = 5.0;  ///< the same in standard deviations
  int neighborhood = 24;          ///< side of the square whose median it exceeds [pixels]; >= 8
};

/// Marks what mirrors the light, `specular`: where all channels exceed the median nearby, since a
/// surface mirrors all wavelengths alike. Highlights wider than half of the neighborhood are not
/// found; crossed polarizers leave none.
/// @throws InvalidInput
void mark_specular(Developed& image, const SpecularOptions& options = {});

}  // namespace lamina
