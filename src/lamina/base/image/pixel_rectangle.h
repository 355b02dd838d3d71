// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace lamina {

/// Pixels of an image, from its upper left corner.
struct PixelRectangle {
  int x = 0, y = 0;
  int width = 0, height = 0;
};

/// @param what  the image and its rectangle, as messages call them: "dark.tif: the gray card".
/// @throws InvalidInput if it is empty or not all of it lies in an image of that size.
void require_inside(const PixelRectangle& rectangle, int width, int height, std::string_view what);

}  // namespace lamina
