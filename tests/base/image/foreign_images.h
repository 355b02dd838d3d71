// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

// Files as other programs write them, made with the format libraries directly, so that loaders are
// not tested on lamina's own files alone. All hold the numbers of `ramp`.

namespace lamina {

/// Value of all files at a pixel of a channel: quarters in [0, 1], exact in half and float.
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
  int compression = 1;                  ///< as numbered by TIFF: 1 none, 5 LZW, 8 deflate
  bool is_grey = false;                 ///< of any number of samples
  int orientation = 0;                  ///< 0: not noted
  std::vector<std::byte> profile = {};  ///< ICC; empty: none
};
[[nodiscard]] std::vector<std::byte> foreign_tiff(int width, int height, const TiffKind& kind);

/// JPEG of one quality above all, so that numbers are off by two of 255 at most.
/// @param components  1 grey, 3 RGB, 4 as for print.
[[nodiscard]] std::vector<std::byte> foreign_jpeg(int width, int height, int components,
                                                  bool is_progressive);

/// A chunk put after the header of a PNG.
[[nodiscard]] std::vector<std::byte> with_png_chunk(std::vector<std::byte> png,
                                                    const std::string& name,
                                                    const std::vector<std::byte>& data);
/// The data of a chunk iCCP.
[[nodiscard]] std::vector<std::byte> iccp_of(const std::vector<std::byte>& profile);

/// A segment put at the start of a JPEG.
/// @param marker  0xE1 for APP1, ...
[[nodiscard]] std::vector<std::byte> with_jpeg_segment(std::vector<std::byte> jpeg, int marker,
                                                       const std::vector<std::byte>& data);
/// A profile in so many pieces, the last one first.
[[nodiscard]] std::vector<std::byte> with_jpeg_profile(std::vector<std::byte> jpeg,
                                                       const std::vector<std::byte>& profile,
                                                       int pieces);

/// Exif as in the chunk eXIf.
/// @param color_space  1 sRGB, 2 Adobe RGB, 65535 uncalibrated, with the rule R03
[[nodiscard]] std::vector<std::byte> foreign_exif(int orientation, int color_space = 1);
[[nodiscard]] std::vector<std::byte> bytes_of(std::string_view text);

enum class HdrRows { flat, old_runs, runs };
/// The numbers of `ramp` (0 and its quarters) are rounded to the middle of what 8 bits tell apart.
/// @param lines  of the header beside its first one and its format
[[nodiscard]] std::vector<std::byte> foreign_hdr(int width, int height, HdrRows rows,
                                                 const std::string& lines = "");

}  // namespace lamina
