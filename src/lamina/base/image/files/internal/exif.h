// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace lamina {

/// Notes of a camera that a reader of pixels has to know.
struct ExifNotes {
  int orientation = 1;        ///< 1 to 8, as TIFF numbers them: 1 is upright
  bool is_adobe_rgb = false;  ///< by the color space 2, or the rule "R03" of DCF
};

/// Reads the tables of a TIFF, as Exif is one; what is damaged there says nothing.
/// Source: [Exif2019] §4.6; the rule "R03" is of [DCF2010] §3.4.
[[nodiscard]] ExifNotes parse_exif(std::span<const std::byte> bytes);

}  // namespace lamina
