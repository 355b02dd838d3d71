// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "lamina/base/image/files/camera_raw.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/image.h"

// What image_file.cpp and the codecs share. Not installed.

namespace lamina {

/// An image file held in memory, and what messages call it.
struct EncodedImage {
  std::span<const std::byte> bytes;
  std::string name;
  ColorEncoding encoding;
  MemoryBudget& memory;  ///< for the image, and at the same time for what its decoder needs
  bool is_turned_upright = true;         ///< where it notes another orientation
  std::size_t more_bytes_per_pixel = 0;  ///< that its reader takes beside the image
};

[[nodiscard]] Image decode_exr(const EncodedImage& file);
[[nodiscard]] Image decode_png(const EncodedImage& file);
[[nodiscard]] Image decode_tiff(const EncodedImage& file);
[[nodiscard]] Image decode_jpeg(const EncodedImage& file);
[[nodiscard]] Image decode_radiance_hdr(const EncodedImage& file);
[[nodiscard]] CameraRaw decode_camera_raw(const EncodedImage& file, Demosaic demosaic);

/// Whether a TIFF file is one of a camera's: a DNG, or one whose first image is a preview of
/// others.
[[nodiscard]] bool is_raw_tiff(const EncodedImage& file);

/// Throws FileError: `NAME: cannot be read as FORMAT: WHY`, in one line.
[[noreturn]] void fail_to_decode(const EncodedImage& file, const char* format,
                                 const std::string& why);

/// Refuses a size that cannot be true, before memory is taken for it.
void require_plausible_size(const EncodedImage& file, const char* format, std::int64_t width,
                            std::int64_t height, std::int64_t channels);

/// Takes the memory of an image from the budget for good, and sees whether `decoder_bytes` are left
/// beside it. Both before they are allocated.
void take_image_memory(const EncodedImage& file, std::size_t width, std::size_t height,
                       std::size_t channels, std::size_t decoder_bytes);

}  // namespace lamina
