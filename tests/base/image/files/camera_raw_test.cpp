// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/camera_raw.h"

#include <gtest/gtest.h>
#include <tiffio.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <vector>

#include "base/image/scratch_folder.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"

namespace lamina {
namespace {

constexpr int raw_width = 64, raw_height = 48, black = 512, white = 15872;
constexpr std::array<double, 3> raw_color = {0.5, 0.25, 0.125};  // of its saturation

/// A DNG of one color that falls off to the right, but for a saturated corner, made by libtiff.
void write_dng(const std::string& name) {
  TIFF* tiff = TIFFOpen(name.c_str(), "w");
  TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, 0);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, raw_width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, raw_height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_CFA);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, raw_height);
  TIFFSetField(tiff, TIFFTAG_MAKE, "Lamina");
  TIFFSetField(tiff, TIFFTAG_MODEL, "Test");
  TIFFSetField(tiff, TIFFTAG_UNIQUECAMERAMODEL, "Lamina Test");
  const std::array<std::uint8_t, 4> version = {1, 4, 0, 0}, backward = {1, 1, 0, 0};
  const std::array<std::uint8_t, 4> pattern = {0, 1, 1, 2};
  const std::array<std::uint16_t, 2> repeat = {2, 2};
  TIFFSetField(tiff, TIFFTAG_DNGVERSION, version.data());
  TIFFSetField(tiff, TIFFTAG_DNGBACKWARDVERSION, backward.data());
  TIFFSetField(tiff, TIFFTAG_CFAREPEATPATTERNDIM, repeat.data());
  TIFFSetField(tiff, TIFFTAG_CFAPATTERN, 4, pattern.data());
  const float black_level = black;
  const std::uint32_t white_level = white;
  TIFFSetField(tiff, TIFFTAG_BLACKLEVEL, 1, &black_level);
  TIFFSetField(tiff, TIFFTAG_WHITELEVEL, 1, &white_level);
  const std::array<float, 9> matrix = {0.9f, -0.3f, -0.1f, -0.4f, 1.2f, 0.2f, -0.05f, 0.2f, 0.6f};
  const std::array<float, 3> neutral = {0.5f, 1.0f, 0.7f};
  TIFFSetField(tiff, TIFFTAG_COLORMATRIX1, 9, matrix.data());
  TIFFSetField(tiff, TIFFTAG_ASSHOTNEUTRAL, 3, neutral.data());
  for (int y = 0; y < raw_height; ++y) {
    std::vector<std::uint16_t> row;
    for (int x = 0; x < raw_width; ++x) {
      const std::size_t color = static_cast<std::size_t>(x % 2 + y % 2);
      const double light = x < 8 && y < 8 ? 1.5 : raw_color[color] * (1.0 - 0.005 * (x / 2 * 2));
      row.push_back(static_cast<std::uint16_t>(
          std::min(std::lround(black + light * (white - black)), static_cast<long>(white))));
    }
    TIFFWriteScanline(tiff, row.data(), static_cast<std::uint32_t>(y));
  }
  const std::uint64_t none = 0;
  TIFFSetField(tiff, TIFFTAG_EXIFIFD, none);
  TIFFWriteDirectory(tiff);
  TIFFCreateEXIFDirectory(tiff);
  const std::uint16_t iso = 400;
  TIFFSetField(tiff, EXIFTAG_EXPOSURETIME, 0.0125);
  TIFFSetField(tiff, EXIFTAG_FNUMBER, 5.6);
  TIFFSetField(tiff, EXIFTAG_ISOSPEEDRATINGS, 1, &iso);
  std::uint64_t place = 0;
  TIFFWriteCustomDirectory(tiff, &place);
  TIFFSetDirectory(tiff, 0);
  TIFFSetField(tiff, TIFFTAG_EXIFIFD, place);
  TIFFRewriteDirectory(tiff);
  TIFFClose(tiff);
}

using CameraRawFile = ScratchFolder;

TEST_F(CameraRawFile, HasTheNumbersOfTheSensor) {
  const std::string file = path("a.dng").string();
  write_dng(file);
  MemoryBudget memory;
  if (!reads_camera_raw()) {
    EXPECT_THROW((void)load_camera_raw(file, Demosaic::half_size, memory), FileError);
    GTEST_SKIP() << "built without libraw";
  }
  const CameraRaw half = load_camera_raw(file, Demosaic::half_size, memory);
  EXPECT_EQ(half.camera, "Lamina Test");
  EXPECT_NEAR(half.exposure_s, 0.0125, 1e-6);
  EXPECT_NEAR(half.f_number, 5.6, 1e-5);
  EXPECT_EQ(half.iso, 400.0);
  ASSERT_EQ(half.image.width, raw_width / 2);
  ASSERT_EQ(half.image.height, raw_height / 2);
  for (int y = 0; y < raw_height / 2; ++y)
    for (int x = 0; x < raw_width / 2; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        const double light = x < 4 && y < 4 ? 1.0 : raw_color[c] * (1.0 - 0.01 * x);
        ASSERT_NEAR(half.image.at(x, y)[c], light, 1e-4) << x << " " << y << " " << c;
      }
  const Image full = load_image(file);
  ASSERT_EQ(full.width, raw_width);
  EXPECT_NEAR(full.at(40, 30)[1], raw_color[1] * 0.8, 5e-3);
  EXPECT_NEAR(full.at(2, 2)[2], 1.0, 1e-4);
  EXPECT_EQ(MemoryBudget{}.left - memory.left, half.image.pixels.size() * sizeof(float));
}

TEST_F(CameraRawFile, ThatIsDamagedIsRefused) {
  const std::string file = path("a.dng").string();
  write_dng(file);
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  MemoryBudget memory;
  for (const std::size_t size : {3, 9, 300, 3000}) {
    std::ofstream(path("cut.dng"), std::ios::binary) << bytes.substr(0, size);
    EXPECT_THROW((void)load_camera_raw(path("cut.dng"), Demosaic::half_size, memory), FileError);
  }
  memory.left = bytes.size() + 4000;
  EXPECT_THROW((void)load_camera_raw(file, Demosaic::half_size, memory), FileError);
  for (const std::string& start : {std::string("FUJIFILMCCD-RAW 0201"), std::string("IIU\0abc", 7),
                                   std::string("\0\0\0\x18"
                                               "ftypcrx isom",
                                               16)})
    EXPECT_THROW((void)decode_image(std::as_bytes(std::span(start)), "a.raf"), FileError);
}

}  // namespace
}  // namespace lamina
