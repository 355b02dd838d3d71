// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include "lamina/base/image/files/image_file.h"

namespace lamina {

/// Where the pixels of an image lie in a larger one: the data window of an EXR file in its display
/// window.
struct ImageFrame {
  int x = 0, y = 0;           ///< of the upper left corner
  int width = 0, height = 0;  ///< of the larger one; 0: there is none
};

/// The save_exr of base/image/files/image_file.h for a region of a picture: programs of compositing put it in
/// its place, and load_image sees the whole with black around it.
/// @throws InvalidInput, WriteError as that
void save_exr(const Image& image, const std::filesystem::path& file, ExrPrecision precision,
              std::span<const ImageNote> notes, RgbSpace space, const ImageFrame& frame);

}  // namespace lamina
