// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/base/image/image.h"
#include "lamina/skin/acquire/calibration/pixel_mask.h"

namespace lamina {

/// The median of numbers, which are reordered: of an even count the upper one; NaN of none.
[[nodiscard]] float median_of(std::vector<float>& values);

/// The median of each channel over the used pixels of a square around each pixel: taken every third
/// of its side, and bilinear between. Where a square has no used pixels, that of the whole image.
/// @param side  of the square [pixels], >= 3
[[nodiscard]] Image local_median(const Image& image, const PixelMask& mask, int side);

}  // namespace lamina
