// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lamina/base/image/image.h"
#include "lamina/skin/acquire/calibration/pixel_mask.h"

namespace lamina {

/// Reading of an image on a card of one color.
struct CardReading {
  std::vector<double> mean;       ///< [channel]
  std::vector<double> deviation;  ///< [channel] standard deviation of its pixels
  std::size_t pixels = 0;
};

/// @param card        the pixels that show nothing but the card, not its rim
/// @param saturation  numbers from this on are saturated
/// @param name        of the image in messages
/// @throws InvalidInput if there are fewer than 16 pixels, one in a hundred is saturated, a mean is
///         not above 0, or the card is not uniform: deviation above a fifth of the mean.
[[nodiscard]] CardReading read_card(const Image& image, const PixelMask& card, double saturation,
                                    const std::string& name);

/// Factors that bring an image to the exposure of another.
struct ExposureRatio {
  std::vector<double> factor;     ///< [channel]
  std::vector<double> deviation;  ///< [channel] relative standard deviation
};

/// By a card that both images show, in the same light as the skin: the other's reading over this
/// one's. Its standard deviation is that of the means, as if a patch of 8 x 8 pixels had one error:
/// what varies over a card is dust and shade, not only noise.
/// @throws InvalidInput if the channels are not as many.
[[nodiscard]] ExposureRatio exposure_ratio(const CardReading& image, const CardReading& other);

/// The number that a white of reflectance 1 would have, [channel], by a card of known reflectance:
/// one for all channels, or one for each, in (0, 2].
[[nodiscard]] std::vector<double> white_level(const CardReading& card,
                                              const std::vector<double>& reflectance);

}  // namespace lamina
