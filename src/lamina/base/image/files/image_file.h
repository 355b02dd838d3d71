// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/image/color_encoding.h"
#include "lamina/base/image/image.h"
#include "lamina/base/spectrum/rgb_space.h"

namespace lamina {

/// How an image is to be read.
struct ImageReading {
  ColorEncoding encoding = ColorEncoding::srgb;
  /// Whether the orientation that a file notes (Exif in JPEG and PNG, a tag of TIFF) is followed.
  bool is_turned_upright = true;
  /// Memory that the caller takes for each pixel beside the image: a file for which it would not be
  /// left is refused before it is decoded.
  std::size_t more_bytes_per_pixel = 0;
};

/// Reads an EXR, PNG, JPEG, TIFF, Radiance HDR, ENVI or camera raw file; what it is, its first
/// bytes say, not its name.
///
/// - EXR: half, float or integer, scan lines or tiles, every compression, every channel name; of a
///   file with several parts the first. The image is the display window; pixels of the data window
///   beyond it are dropped, pixels of it without data are 0. Deep images are refused. Colors of
///   other primaries than Rec.709's, as ACEScg, are turned into those.
/// - PNG: every kind. Channels "Y" or "R", "G", "B", then "A" if there is transparency.
/// - JPEG: grey or color of 8 bits.
/// - Radiance HDR (.hdr): RGBE, from the top left; divided by its exposure.
/// - TIFF: grey or RGB, with or without alpha, 8, 16 or 32 bits, or 16, 32 or 64 bit
///   floating point. Samples beyond the colors that are not declared alpha are data: the channels
///   of a grey file with such are "band 1", "band 2", ..., those of an RGB file "R", "G", "B",
///   "band 4", ...
/// - ENVI: the path of its header; see load_envi for parts of large files.
/// - Camera raw, where lamina is built with libraw: linear colors of the sensor (load_camera_raw).
///
/// Colors are turned as ColorEncoding says, pictures upright. Colors beyond the triangle of Rec.709
/// lose what is negative, since reflectances and light have none; what is above 1 stays.
///
/// @return  integers scaled to [0, 1]; floating point numbers as they are,
///          infinities and NaN included (see require_finite).
/// @throws  FileError if the file is missing, not an image, cut short, damaged where that shows,
///          claims a size that its length cannot hold, says colors that cannot be read (a damaged
///          profile, one of print, PQ), or takes more memory than is left; that of
///          the decoder counts, too. What the image takes stays taken from the budget.
[[nodiscard]] Image load_image(const std::filesystem::path& file, const ImageReading& reading,
                               MemoryBudget& memory);
[[nodiscard]] Image load_image(const std::filesystem::path& file, ColorEncoding encoding,
                               MemoryBudget& memory);
[[nodiscard]] Image load_image(const std::filesystem::path& file,
                               ColorEncoding encoding = ColorEncoding::srgb);

/// Decodes the bytes of a file, as in a GLB; `name` stands for the file in messages.
[[nodiscard]] Image decode_image(std::span<const std::byte> bytes, const std::string& name,
                                 const ImageReading& reading, MemoryBudget& memory);
[[nodiscard]] Image decode_image(std::span<const std::byte> bytes, const std::string& name,
                                 ColorEncoding encoding, MemoryBudget& memory);
[[nodiscard]] Image decode_image(std::span<const std::byte> bytes, const std::string& name,
                                 ColorEncoding encoding = ColorEncoding::srgb);

/// @throws FileError naming the first pixel and channel that is infinite or NaN.
void require_finite(const Image& image, const std::filesystem::path& file);

enum class ExrPrecision {
  half,          ///< 11 significant bits; finite numbers beyond ±65504 become that
  single_float,  ///< all of them
};

/// Writes all channels, with ZIP compression; channels of Cryptomatte (base/image/cryptomatte.h)
/// keep all their bits. The file appears whole or not at all.
/// @param space  that the colors, linear Rec.709, are turned into; the file says its primaries
/// @throws InvalidInput if there are no pixels or two channels have one name; WriteError.
void save_exr(const Image& image, const std::filesystem::path& file,
              ExrPrecision precision = ExrPrecision::half, std::span<const ImageNote> notes = {},
              RgbSpace space = RgbSpace::rec709);

/// Writes 8 bit sRGB from linear "R", "G", "B" (or "Y"), and "A" if there is one, which stays
/// linear; other channels are left out. Numbers outside [0, 1] are clamped, NaN is 0. Equal images
/// give equal bytes. The file appears whole or not at all.
/// @throws InvalidInput if there are no pixels or no such channels; WriteError.
void save_png(const Image& image, const std::filesystem::path& file);

/// The bytes that save_exr and save_png write.
[[nodiscard]] std::vector<std::byte> encode_exr(const Image& image,
                                                ExrPrecision precision = ExrPrecision::half,
                                                std::span<const ImageNote> notes = {},
                                                RgbSpace space = RgbSpace::rec709);
[[nodiscard]] std::vector<std::byte> encode_png(const Image& image);

}  // namespace lamina
