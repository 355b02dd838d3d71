// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lamina/base/image/image.h"

namespace lamina {

/// Whether rows of the file are columns of the upright picture.
[[nodiscard]] constexpr bool swaps_sides(int orientation) { return orientation >= 5; }

/// Memory that `upright` takes beside the image [bytes].
[[nodiscard]] constexpr std::size_t turning_bytes(int orientation, std::size_t width,
                                                  std::size_t height, std::size_t channels) {
  return orientation > 1 ? width * height * channels * sizeof(float) : 0;
}

/// The picture as it is to be seen, of one that a file holds in another orientation.
/// @param orientation  1 to 8. Source: [TIFF6] §8, Orientation
[[nodiscard]] Image upright(Image image, int orientation);

}  // namespace lamina
