// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lamina/base/image/image.h"

namespace lamina {

struct SheetPicture {
  std::string caption;  ///< below it; one line
  Image image;          ///< as save_png takes it
};

/// Pictures side by side, each with its caption, as one SVG file that holds them.
///
/// @param title    above them, if not empty
/// @param columns  pictures in a row, >= 1
/// @throws InvalidInput if a picture cannot be written as PNG.
[[nodiscard]] std::string format_sheet(const std::string& title,
                                       const std::vector<SheetPicture>& pictures, int columns);

/// Differences of luminance between a render and a reference: white where they agree, towards red
/// where the render is brighter, blue where it is darker.
///
/// @param range  relative difference of full colour, > 0; of what is darker than a quarter of the
///               reference's mean, relative to that.
/// @return       channels R, G, B for save_png
/// @throws InvalidInput if the sizes differ or R, G, B are missing
[[nodiscard]] Image difference_map(const Image& render, const Image& reference, double range);

}  // namespace lamina
