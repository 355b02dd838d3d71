// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/image/files/internal/color_statement.h"
#include "lamina/base/image/files/internal/exif.h"

namespace lamina {

/// Notes that stand in a JPEG before its pixels: Exif, and an ICC profile in any number of pieces.
/// Source: [JPEG1992] §B.1.1.4; the pieces of a profile: [ICC2010] §B.4.
struct JpegNotes {
  ExifNotes exif;
  ColorStatement colors;
};

[[nodiscard]] JpegNotes read_jpeg_notes(const EncodedImage& file);

}  // namespace lamina
