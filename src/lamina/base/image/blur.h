// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lamina/base/image/image.h"

namespace lamina {

/// A place in an endless row of mirror images of `length` texels, in the first of them.
[[nodiscard]] std::size_t mirrored_index(int i, int length);

/// A Gaussian blur of an image that goes on as its mirror image.
/// @param image   one channel, [y][x]
/// @param spread  standard deviation [texel], > 0; the time grows with it
[[nodiscard]] std::vector<float> blurred(const std::vector<float>& image, int width, int height,
                                         double spread);

/// Blurs all channels in a time that does not grow with the spread: wide blurs are done on a
/// coarser image, whose tents count as part of the spread. 0 changes nothing.
[[nodiscard]] Image blurred(const Image& image, double spread);

}  // namespace lamina
