// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lamina/base/image/image.h"
#include "lamina/skin/acquire/calibration/pixel_mask.h"

// What functions on several images ask of them.

namespace lamina {

/// Throws InvalidInput unless a mask has the size of an image.
void require_size(const PixelMask& mask, const Image& image, const std::string& what);

/// Throws InvalidInput unless an image has the size and channels of another.
void require_like(const Image& image, const Image& other, const std::string& what);

/// Throws InvalidInput unless there is one number for all channels or one for each, all finite.
void require_one_or_each(const std::vector<double>& numbers, const Image& image,
                         const std::string& what);

/// The number of a channel in a list of one for all or one for each.
[[nodiscard]] inline double of_channel(const std::vector<double>& numbers, std::size_t channel) {
  return numbers[numbers.size() == 1 ? 0 : channel];
}

/// Marks pixels of which a channel is infinite or NaN.
void mark_not_finite(PixelMask& mask, const Image& image);

}  // namespace lamina
