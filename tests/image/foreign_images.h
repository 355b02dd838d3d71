// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

// Files as other programs write them, made with the format libraries directly, so that loaders are
// not tested on lamina's own files alone. All hold the numbers of `ramp`.

namespace lamina {

/// What all files hold at a pixel of a channel: quarters in [0, 1], exact in half and float.
[[nodiscard]] float ramp(int x, int y, std::size_t channel);

enum class ExrKind { scan_lines, tiles, mipmaps };

/// @param compression  as numbered by OpenEXR: 0 none ... 9 DWAB.
/// @param inset        by how many pixels the data window is smaller than the display window on
///                     all sides; larger where negative.
[[nodiscard]] std::vector<std::byte> foreign_exr(int width, int height, ExrKind kind,
                                                 int compression, int inset = 0,
                                                 bool is_float = false);
[[nodiscard]] std::vector<std::byte> deep_exr();
[[nodiscard]] std::vector<std::byte> chroma_exr();

/// @param color_type  as numbered by PNG: 0 grey, 2 RGB, 3 palette, 4 grey + alpha, 6 RGBA.
/// The palette image holds colour 0 = (0, 128, 255) and colour 1 = (255, 128, 0), alternating.
[[nodiscard]] std::vector<std::byte> foreign_png(int width, int height, int color_type, int bits,
                                                 bool is_interlaced);

struct TiffKind {
  int samples = 3, bits = 8;
  bool is_float = false, is_planar = false, is_tiled = false, is_big_endian = false;
  int compression = 1;  ///< as numbered by TIFF: 1 none, 5 LZW, 8 deflate
};
[[nodiscard]] std::vector<std::byte> foreign_tiff(int width, int height, const TiffKind& kind);

/// Of one quality above all, so that numbers are off by two of 255 at most.
/// @param components  1 grey, 3 RGB, 4 as for print.
[[nodiscard]] std::vector<std::byte> foreign_jpeg(int width, int height, int components,
                                                  bool is_progressive);

enum class HdrRows { flat, old_runs, runs };
/// The numbers of `ramp` (0 and its quarters) are rounded to the middle of what 8 bits tell apart.
/// @param lines  of the header beside its first one and its format
[[nodiscard]] std::vector<std::byte> foreign_hdr(int width, int height, HdrRows rows,
                                                 const std::string& lines = "");

}  // namespace lamina
