// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <zlib.h>

#include <string>
#include <utility>
#include <vector>

#include "base/image/foreign_images.h"
#include "base/image/icc_profiles.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/random.h"
#include "lamina/base/image/files/image_file.h"

// Files that were cut, damaged in transfer, or made to harm. Reading one is a FileError, or gives
// an image where the damage does not show; never a crash, a hang, or memory without bound.

namespace lamina {
namespace {

using Bytes = std::vector<std::byte>;

/// One small file of each kind whose reading takes a path of its own.
std::vector<std::pair<std::string, Bytes>> valid_files() {
  std::vector<std::pair<std::string, Bytes>> files;
  for (const int compression : {0, 1, 2, 3, 4, 5, 6, 8, 9})
    files.emplace_back("exr lines " + std::to_string(compression),
                       foreign_exr(20, 18, ExrKind::scan_lines, compression));
  files.emplace_back("exr tiles", foreign_exr(20, 18, ExrKind::tiles, 3));
  files.emplace_back("exr mipmaps", foreign_exr(20, 18, ExrKind::mipmaps, 4));
  files.emplace_back("png rgb", foreign_png(20, 18, 2, 8, false));
  files.emplace_back("png palette", foreign_png(20, 18, 3, 2, true));
  files.emplace_back("png rgba 16", foreign_png(20, 18, 6, 16, true));
  for (const int compression : {1, 5, 8})
    files.emplace_back("tiff " + std::to_string(compression),
                       foreign_tiff(20, 18, {.compression = compression}));
  files.emplace_back("tiff tiles",
                     foreign_tiff(20, 18, {.bits = 32, .is_float = true, .is_tiled = true}));
  files.emplace_back("tiff planes", foreign_tiff(20, 18, {.is_planar = true, .compression = 5}));
  files.emplace_back("jpeg", foreign_jpeg(20, 18, 3, false));
  files.emplace_back("jpeg progressive", foreign_jpeg(20, 18, 1, true));
  files.emplace_back("hdr runs", foreign_hdr(20, 18, HdrRows::runs));
  files.emplace_back("hdr flat", foreign_hdr(20, 18, HdrRows::flat));
  files.emplace_back("hdr old runs", foreign_hdr(20, 18, HdrRows::old_runs));
  const Bytes profile = p3_profile();
  files.emplace_back("png with a profile",
                     with_png_chunk(foreign_png(20, 18, 2, 8, false), "iCCP", iccp_of(profile)));
  files.emplace_back("jpeg with a profile",
                     with_jpeg_profile(foreign_jpeg(20, 18, 3, false), profile, 3));
  Bytes exif = bytes_of(std::string_view("Exif\0\0", 6));
  const Bytes notes = foreign_exif(6, 65535);
  exif.insert(exif.end(), notes.begin(), notes.end());
  files.emplace_back("jpeg with exif",
                     with_jpeg_segment(foreign_jpeg(20, 18, 3, false), 0xE1, exif));
  files.emplace_back("tiff with a profile",
                     foreign_tiff(20, 18, {.orientation = 6, .profile = profile}));
  return files;
}

/// Whether the bytes are read; anything but an image or a FileError in one line fails the test.
bool is_read(const Bytes& bytes, const std::string& name) {
  try {
    const Image image = decode_image(bytes, name);
    EXPECT_EQ(image.pixels.size(), static_cast<std::size_t>(image.width) *
                                       static_cast<std::size_t>(image.height) *
                                       image.channel_count());
    return true;
  } catch (const FileError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return false;
  }
}

TEST(DamagedImage, CutAnywhereIsRefused) {
  for (const auto& [name, bytes] : valid_files()) {
    ASSERT_TRUE(is_read(bytes, name)) << name;
    const std::size_t step = std::max<std::size_t>(1, bytes.size() / 150);
    for (std::size_t size = 0; size < bytes.size(); size += step) {
      const bool has_all_pixels = name.starts_with("tiff") || name == "exr mipmaps";
      const bool accepted =
          is_read(Bytes(bytes.begin(), bytes.begin() + static_cast<long>(size)), name);
      // The end of a TIFF may be padding, that of mipmaps the levels that are not read.
      if (accepted && !has_all_pixels) ADD_FAILURE() << name << " cut to " << size << " bytes";
    }
  }
}

TEST(DamagedImage, WithFlippedBitsNeverCrashes) {
  for (const auto& [name, bytes] : valid_files())
    for (std::uint64_t i = 0; i < 2000; ++i) {
      Random random = make_random(7, i);
      Bytes damaged = bytes;
      const int flips = 1 + static_cast<int>(random.uniform() * 4.0);
      for (int flip = 0; flip < flips; ++flip) {
        // Half of the damage goes to the first bytes, where the structure is.
        const double reach = flip % 2 == 0 ? std::min(400.0, static_cast<double>(bytes.size()))
                                           : static_cast<double>(bytes.size());
        const auto at = static_cast<std::size_t>(random.uniform() * reach);
        damaged[at] ^= static_cast<std::byte>(1 + static_cast<int>(random.uniform() * 255.0));
      }
      (void)is_read(damaged, name);
    }
}

TEST(DamagedImage, EndingInGarbageNeverCrashes) {
  for (const auto& [name, bytes] : valid_files())
    for (std::uint64_t i = 0; i < 300; ++i) {
      Random random = make_random(8, i);
      Bytes damaged = bytes;
      for (auto at = static_cast<std::size_t>(random.uniform() * static_cast<double>(bytes.size()));
           at < bytes.size(); ++at)
        damaged[at] = static_cast<std::byte>(random.bits() & 255);
      (void)is_read(damaged, name);
    }
}

void put(Bytes& bytes, std::size_t at, std::uint32_t value, bool is_big_endian) {
  for (std::size_t i = 0; i < 4; ++i)
    bytes[at + i] = static_cast<std::byte>(value >> (8 * (is_big_endian ? 3 - i : i)));
}

std::string refusal(const Bytes& bytes, const std::string& name) {
  try {
    (void)decode_image(bytes, name);
  } catch (const FileError& error) {
    return error.what();
  }
  return "was read";
}

TEST(DamagedImage, OfAbsurdSizeIsRefusedBeforeMemoryIsTaken) {
  Bytes png = foreign_png(8, 8, 2, 8, false);
  put(png, 16, 100'000, true);
  put(png, 20, 100'000, true);
  const auto* header = reinterpret_cast<const Bytef*>(png.data()) + 12;
  put(png, 29, static_cast<std::uint32_t>(crc32(0, header, 17)), true);
  EXPECT_NE(refusal(png, "big.png").find("100000 x 100000"), std::string::npos)
      << refusal(png, "big.png");

  Bytes exr = foreign_exr(8, 8, ExrKind::scan_lines, 3);
  const std::string text(reinterpret_cast<const char*>(exr.data()), exr.size());
  for (const std::string window : {"dataWindow", "displayWindow"}) {
    const std::size_t at = text.find(window) + window.size() + 1 + 6 + 4;  // name, "box2i", length
    put(exr, at + 8, 99'999, false);
    put(exr, at + 12, 99'999, false);
    EXPECT_NE(refusal(exr, "big.exr").find("100000 x 100000"), std::string::npos)
        << refusal(exr, "big.exr");
  }

  Bytes tiff = foreign_tiff(8, 8, {});
  for (std::size_t at = 0; at + 12 <= tiff.size(); ++at)  // tags 256, 257 of type 3, count 1
    for (const int tag : {0, 1})
      if (tiff[at] == std::byte(tag) && tiff[at + 1] == std::byte{1} &&
          tiff[at + 2] == std::byte{3} && tiff[at + 4] == std::byte{1}) {
        tiff[at + 2] = std::byte{4};
        put(tiff, at + 8, 100'000, false);
      }
  EXPECT_NE(refusal(tiff, "big.tif").find("100000 x 100000"), std::string::npos)
      << refusal(tiff, "big.tif");
}

TEST(DamagedImage, OfAbsurdSizeInTextIsRefusedToo) {
  const std::string text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n";
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  EXPECT_NE(refusal(Bytes(bytes, bytes + text.size()), "big.hdr").find("100000 x 100000"),
            std::string::npos);
  Bytes jpeg = foreign_jpeg(8, 8, 3, false);
  for (std::size_t at = 0; at + 9 < jpeg.size(); ++at)
    if (jpeg[at] == std::byte{0xff} && jpeg[at + 1] == std::byte{0xc0})  // the frame: rows, columns
      for (const std::size_t i : {5, 6, 7, 8}) jpeg[at + i] = std::byte{0xf0};
  EXPECT_NE(refusal(jpeg, "big.jpg").find("61680 x 61680"), std::string::npos)
      << refusal(jpeg, "big.jpg");
}

TEST(DamagedImage, WithLengthsBeyondItsEndIsRefused) {
  Bytes exr = foreign_exr(8, 8, ExrKind::scan_lines, 3);
  const std::string text(reinterpret_cast<const char*>(exr.data()), exr.size());
  put(exr, text.find("channels") + 9 + 7, 0x7fffffff, false);
  EXPECT_NE(refusal(exr, "long.exr").find("ends within the header"), std::string::npos);
}

}  // namespace
}  // namespace lamina
