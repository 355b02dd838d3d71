// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/internal/orientation.h"

#include <algorithm>
#include <utility>

namespace lamina {

Image upright(Image image, int orientation) {
  if (orientation <= 1 || orientation > 8) return image;
  const bool swaps = swaps_sides(orientation);
  Image turned = make_image(swaps ? image.height : image.width, swaps ? image.width : image.height,
                            image.channels);
  const int last_column = image.width - 1, last_row = image.height - 1;
  // Row 0 of the file is the right of the picture in 6 and 7, its bottom in 3 and 4; column 0 is
  // the bottom in 7 and 8, the right in 2 and 3.
  const bool from_last_row =
      orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
  const bool from_last_column =
      orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
  for (int y = 0; y < turned.height; ++y)
    for (int x = 0; x < turned.width; ++x) {
      const int row = swaps ? x : y, column = swaps ? y : x;
      const float* from = image.at(from_last_column ? last_column - column : column,
                                   from_last_row ? last_row - row : row);
      std::copy(from, from + image.channel_count(), turned.at(x, y));
    }
  return turned;
}

}  // namespace lamina
