// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/pixel_rectangle.h"

#include <string>

#include "lamina/base/core/error.h"

namespace lamina {

void require_inside(const PixelRectangle& r, int width, int height, std::string_view what) {
  if (r.x >= 0 && r.y >= 0 && r.width > 0 && r.height > 0 && r.x < width && r.y < height &&
      r.width <= width - r.x && r.height <= height - r.y)
    return;
  throw InvalidInput(std::string(what) + " must lie in the image of " + std::to_string(width) +
                     " x " + std::to_string(height) + " pixels, but is " + std::to_string(r.width) +
                     " x " + std::to_string(r.height) + " at (" + std::to_string(r.x) + ", " +
                     std::to_string(r.y) + ")");
}

}  // namespace lamina
