// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <zlib.h>

#include <string>
#include <utility>
#include <vector>

#include "base/image/foreign_images.h"
#include "base/image/peak_memory.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"

// A small file can claim a huge picture, honestly: what is uniform shrinks a thousand times.

namespace lamina {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::size_t mebi = std::size_t{1} << 20;
constexpr int width = 1000, height = 700;

std::vector<std::pair<std::string, Bytes>> pictures() {
  std::vector<std::pair<std::string, Bytes>> files;
  files.emplace_back("rows.png", foreign_png(width, height, 2, 8, false));
  files.emplace_back("interlaced.png", foreign_png(width, height, 6, 16, true));
  files.emplace_back("palette.png", foreign_png(width, height, 3, 2, false));
  for (const int compression : {0, 3, 4, 6, 9})
    files.emplace_back("lines" + std::to_string(compression) + ".exr",
                       foreign_exr(width, height, ExrKind::scan_lines, compression));
  files.emplace_back("tiles.exr", foreign_exr(width, height, ExrKind::tiles, 3));
  files.emplace_back("cropped.exr", foreign_exr(width, height, ExrKind::scan_lines, 3, -20));
  for (const int compression : {1, 5, 8})
    files.emplace_back("strips" + std::to_string(compression) + ".tif",
                       foreign_tiff(width, height, {.bits = 16, .compression = compression}));
  files.emplace_back("planes.tif", foreign_tiff(width, height, {.is_planar = true}));
  files.emplace_back("tiles.tif",
                     foreign_tiff(width, height, {.bits = 32, .is_float = true, .is_tiled = true}));
  return files;
}

std::string refusal(const Bytes& bytes, const std::string& name, std::size_t budget) {
  MemoryBudget memory{budget};
  try {
    (void)decode_image(bytes, name, ColorEncoding::linear, memory);
  } catch (const FileError& error) {
    return error.what();
  }
  return {};
}

TEST(ImageMemory, IsRefusedWithTheSizeBeforeItIsTaken) {
  for (const auto& [name, bytes] : pictures()) {
    std::string message;
    const auto peak = peak_memory([&] { message = refusal(bytes, name, 4 * mebi); });
    EXPECT_NE(message.find(name + ": 1000 x 700 pixels of "), std::string::npos) << message;
    EXPECT_NE(message.find("only 4 MiB are left of the budget"), std::string::npos) << message;
    if (peak) {
      EXPECT_LT(*peak, 3 * mebi) << name;
    }
  }
}

TEST(ImageMemory, OfTheImageStaysTaken) {
  MemoryBudget memory;
  const std::size_t before = memory.left;
  const Image image =
      decode_image(foreign_png(30, 20, 2, 8, true), "f.png", ColorEncoding::srgb, memory);
  EXPECT_EQ(before - memory.left, image.pixels.size() * sizeof(float));
}

// The smallest budget that a file is read with must hold all that reading takes, libraries
// included.
TEST(ImageMemory, IsCountedInFull) {
  for (const auto& [name, bytes] : pictures()) {
    std::size_t low = 0, high = 256 * mebi;  // refused with, read with
    ASSERT_EQ(refusal(bytes, name, high), "") << name;
    while (high - low > mebi / 2) {
      const std::size_t middle = low + (high - low) / 2;
      (refusal(bytes, name, middle).empty() ? high : low) = middle;
    }
    const auto peak = peak_memory([&] { (void)refusal(bytes, name, high); });
    if (!peak) GTEST_SKIP() << "the system does not tell how much memory is in use";
    EXPECT_LT(*peak, high + 2 * mebi) << name;
  }
}

void put(Bytes& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(std::byte(value >> shift & 255));
}

/// A PNG chunk of deflated text.
Bytes text_chunk(std::size_t size) {
  std::string chunk = "zTXtComment";
  chunk.append(2, '\0');  // ends the key; deflate
  std::vector<Bytef> packed(compressBound(size));
  uLongf packed_size = packed.size();
  const std::string text(size, ' ');
  compress(packed.data(), &packed_size, reinterpret_cast<const Bytef*>(text.data()), size);
  chunk.append(reinterpret_cast<const char*>(packed.data()), packed_size);
  Bytes bytes;
  put(bytes, static_cast<std::uint32_t>(chunk.size() - 4));
  for (const char c : chunk) bytes.push_back(static_cast<std::byte>(c));
  put(bytes, static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(chunk.data()),
                                              static_cast<uInt>(chunk.size()))));
  return bytes;
}

TEST(ImageMemory, IsNotSpentOnTextInPictures) {
  Bytes png = foreign_png(8, 8, 2, 8, false);
  const Bytes chunk = text_chunk(4 * mebi);
  constexpr std::ptrdiff_t after_header = 8 + 25;
  for (int i = 0; i < 50; ++i) png.insert(png.begin() + after_header, chunk.begin(), chunk.end());
  std::string message;
  const auto peak = peak_memory([&] { message = refusal(png, "chatty.png", 8 * mebi); });
  EXPECT_EQ(message, "");
  if (peak) {
    EXPECT_LT(*peak, 8 * mebi);
  }
}

}  // namespace
}  // namespace lamina
