// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "base/image/foreign_images.h"
#include "base/image/icc_profiles.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/spectrum/srgb.h"

// What files say of their colors and of which side is up.

namespace lamina {
namespace {

using Bytes = std::vector<std::byte>;
using Color = std::array<double, 3>;

Bytes big_endian(std::initializer_list<std::uint32_t> numbers) {
  Bytes bytes;
  for (const std::uint32_t number : numbers)
    for (int shift = 24; shift >= 0; shift -= 8)
      bytes.push_back(static_cast<std::byte>(number >> shift));
  return bytes;
}

/// Numbers of the file at a pixel, before they are light.
Color numbers_at(int x, int y, double largest = 255.0) {
  const auto at = [&](std::size_t c) {
    return std::round(static_cast<double>(ramp(x, y, c)) * largest) / largest;
  };
  return {at(0), at(1), at(2)};
}

/// Display P3 in linear Rec.709 by the published matrix. Source: CSS Color 4, section 10.12 "Sample
/// code for color conversions", the product of its matrices P3 to XYZ and XYZ to sRGB.
Color from_p3(const Color& p3) {
  const Color light = {srgb_decode(p3[0]), srgb_decode(p3[1]), srgb_decode(p3[2])};
  constexpr std::array<Color, 3> rows = {{{1.2249401763, -0.2249401763, 0.0},
                                          {-0.0420569547, 1.0420569547, 0.0},
                                          {-0.0196375546, -0.0786360456, 1.0982736001}}};
  Color color{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) color[r] += rows[r][c] * light[c];
    color[r] = std::max(color[r], 0.0);
  }
  return color;
}

template <class Expected>
void expect_colors(const Image& image, const Expected& expected, double tolerance) {
  ASSERT_GE(image.channel_count(), 3U);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Color color = expected(x, y);
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(static_cast<double>(image.at(x, y)[c]), color[c], tolerance)
            << x << " " << y << " " << c;
    }
}

std::string refusal(const Bytes& bytes, const ImageReading& reading = {}) {
  MemoryBudget memory;
  try {
    (void)decode_image(bytes, "f", reading, memory);
  } catch (const FileError& error) {
    return error.what();
  }
  return "was read";
}

constexpr double rounding_of_profiles = 2e-4;  // their numbers are of 16 bits

TEST(FileColors, OfDisplayP3BecomeRec709WhateverTheFormat) {
  const auto p3 = [](int x, int y) { return from_p3(numbers_at(x, y)); };
  const Bytes png = foreign_png(9, 7, 2, 8, false), profile = p3_profile();
  expect_colors(decode_image(with_png_chunk(png, "iCCP", iccp_of(profile)), "a.png"), p3,
                rounding_of_profiles);
  expect_colors(decode_image(foreign_tiff(9, 7, {.profile = profile}), "a.tif"), p3,
                rounding_of_profiles);
  const Bytes cicp = {std::byte{12}, std::byte{13}, std::byte{0}, std::byte{1}};
  expect_colors(decode_image(with_png_chunk(png, "cICP", cicp), "a.png"), p3, 1e-6);
  const Bytes jpeg = foreign_jpeg(9, 7, 3, false);
  const Image stored = decode_image(jpeg, "a.jpg", ColorEncoding::linear);
  for (const int pieces : {1, 2, 5})
    expect_colors(
        decode_image(with_jpeg_profile(jpeg, profile, pieces), "a.jpg"),
        [&](int x, int y) {
          const float* number = stored.at(x, y);
          return from_p3({static_cast<double>(number[0]), static_cast<double>(number[1]),
                          static_cast<double>(number[2])});
        },
        rounding_of_profiles);
}

TEST(FileColors, OfSixteenBitsAndAlphaKeepBoth) {
  const Bytes png = with_png_chunk(foreign_png(9, 7, 6, 16, true), "iCCP", iccp_of(p3_profile()));
  const Image image = decode_image(png, "a.png");
  expect_colors(
      image, [](int x, int y) { return from_p3(numbers_at(x, y, 65535.0)); }, rounding_of_profiles);
  EXPECT_NEAR(image.at(2, 3)[3], ramp(2, 3, 3), 1e-4);
}

TEST(FileColors, OfProfilesOfTablesAreRead) {
  const Bytes png =
      with_png_chunk(foreign_png(9, 7, 2, 8, false), "iCCP", iccp_of(table_profile(p3_profile())));
  expect_colors(
      decode_image(png, "a.png"), [](int x, int y) { return from_p3(numbers_at(x, y)); }, 0.01);
}

TEST(FileColors, OfGreyProfilesAreRead) {
  const Bytes grey = foreign_png(9, 7, 0, 8, false);
  const Image image = decode_image(with_png_chunk(grey, "iCCP", iccp_of(grey_profile(1.8))), "a");
  ASSERT_EQ(image.channels, std::vector<std::string>{"Y"});
  for (int x = 0; x < 9; ++x)
    EXPECT_NEAR(static_cast<double>(image.at(x, 2)[0]), std::pow(numbers_at(x, 2)[0], 1.8), 2e-4);
}

TEST(FileColors, ThatAFileOfLightSaysStayLight) {
  // A 16 bit PNG with gAMA 1, and one of linear Display P3, of which "linear" turns the primaries.
  const Bytes png = foreign_png(9, 7, 2, 16, false);
  const auto numbers = [](int x, int y) { return numbers_at(x, y, 65535.0); };
  expect_colors(decode_image(with_png_chunk(png, "gAMA", big_endian({100000})), "a"), numbers,
                1e-6);
  const Bytes p3 = with_png_chunk(png, "iCCP", iccp_of(p3_profile(1.0)));
  const auto turned = [](int x, int y) {
    Color number = numbers_at(x, y, 65535.0);
    for (double& each : number) each = srgb_encode(each);
    return from_p3(number);
  };
  for (const auto encoding : {ColorEncoding::srgb, ColorEncoding::linear_colors})
    expect_colors(decode_image(p3, "a", encoding), turned, rounding_of_profiles);
  expect_colors(decode_image(p3, "a", ColorEncoding::linear), numbers, 1e-6);  // quantities
}

TEST(FileColors, OfDataAndOfEncodingsByNameAreWhatTheUserSays) {
  const Bytes png = with_png_chunk(foreign_png(9, 7, 2, 8, false), "iCCP", iccp_of(p3_profile()));
  const auto numbers = [](int x, int y) { return numbers_at(x, y); };
  for (const auto encoding :
       {ColorEncoding::linear, ColorEncoding::linear_colors, ColorEncoding::lin_rec709})
    expect_colors(decode_image(png, "a", encoding), numbers, 1e-6);
  const auto srgb = [](int x, int y) {
    Color color = numbers_at(x, y);
    for (double& each : color) each = srgb_decode(each);
    return color;
  };
  for (const auto encoding : {ColorEncoding::srgb_numbers, ColorEncoding::srgb_texture})
    expect_colors(decode_image(png, "a", encoding), srgb, 1e-6);
  const Bytes bare = foreign_png(9, 7, 2, 8, false);
  expect_colors(decode_image(bare, "a", ColorEncoding::srgb), srgb, 1e-6);
  expect_colors(
      decode_image(bare, "a", ColorEncoding::srgb_displayp3),
      [](int x, int y) { return from_p3(numbers_at(x, y)); }, 1e-6);
}

TEST(FileColors, OfChunksOfPngCountInTheOrderOfTheSpecification) {
  // W3C PNG (third edition), table of color chunk priority: cICP, iCCP, sRGB, gAMA and cHRM.
  const Bytes gamma = big_endian({55556});  // 1/1.8
  const auto power = [](int x, int y) {
    Color color = numbers_at(x, y);
    for (double& each : color) each = std::pow(each, 100000.0 / 55556.0);
    return color;
  };
  const auto srgb = [](int x, int y) {
    Color color = numbers_at(x, y);
    for (double& each : color) each = srgb_decode(each);
    return color;
  };
  const auto p3 = [](int x, int y) { return from_p3(numbers_at(x, y)); };
  Bytes png = with_png_chunk(foreign_png(9, 7, 2, 8, false), "gAMA", gamma);
  expect_colors(decode_image(png, "a"), power, 1e-6);
  const Bytes wide = with_png_chunk(  // the primaries of Display P3
      foreign_png(9, 7, 2, 8, false), "cHRM",
      big_endian({31270, 32900, 68000, 32000, 26500, 69000, 15000, 6000}));
  expect_colors(decode_image(wide, "a"), p3, 1e-6);
  png = with_png_chunk(png, "sRGB", {std::byte{0}});
  expect_colors(decode_image(png, "a"), srgb, 1e-6);
  png = with_png_chunk(png, "iCCP", iccp_of(p3_profile()));
  expect_colors(decode_image(png, "a"), p3, rounding_of_profiles);
  png = with_png_chunk(png, "cICP", {std::byte{1}, std::byte{13}, std::byte{0}, std::byte{1}});
  expect_colors(decode_image(png, "a"), srgb, 1e-6);
  // What sRGB files have for readers that do not know its curve.
  expect_colors(
      decode_image(with_png_chunk(foreign_png(9, 7, 2, 8, false), "gAMA", big_endian({45455})),
                   "a"),
      srgb, 1e-6);
}

TEST(FileColors, OfRadiancePicturesAreOfTheirPrimaries) {
  const Image plain = decode_image(foreign_hdr(9, 7, HdrRows::runs), "a.hdr");
  const Bytes wide =
      foreign_hdr(9, 7, HdrRows::runs, "PRIMARIES= .680 .320 .265 .690 .150 .060 .3127 .3290\n");
  expect_colors(
      decode_image(wide, "a.hdr"),
      [&](int x, int y) {
        Color number{};
        for (std::size_t c = 0; c < 3; ++c)
          number[c] = srgb_encode(static_cast<double>(plain.at(x, y)[c]));
        return from_p3(number);
      },
      1e-5);
  EXPECT_EQ(decode_image(wide, "a.hdr", ColorEncoding::lin_rec709).pixels, plain.pixels);
}

TEST(FileColors, OfExrAreOfTheEncodingThatAUserNames) {
  Image image = make_image(1, 1, {"R", "G", "B"});
  image.pixels = {0.5f, 0.0f, 0.0f};
  const Bytes bytes = encode_exr(image, ExrPrecision::single_float);
  EXPECT_EQ(rgb_image(decode_image(bytes, "a.exr")).pixels, image.pixels);
  // ACEScg's red in linear Rec.709 by the published matrix (ACES white, Bradford): 1.70505, and
  // below 0.
  const Image turned = rgb_image(decode_image(bytes, "a.exr", ColorEncoding::acescg));
  EXPECT_NEAR(turned.pixels[0], 0.5 * 1.70505, 1e-4);
  EXPECT_EQ(turned.pixels[1], 0.0f);
  EXPECT_NEAR(rgb_image(decode_image(bytes, "a.exr", ColorEncoding::g22_rec709)).pixels[0],
              std::pow(0.5, 2.2), 1e-6);
}

TEST(FileColors, OfCamerasThatNoteAdobeRgbAreTurned) {
  // Adobe RGB (1998) color image encoding, section 4.3.5 and annex: the matrix to sRGB follows from
  // its primaries; red alone has 1.39836 of Rec.709's red, green alone -0.39836 of it.
  for (const int space : {2, 65535}) {
    Bytes exif = bytes_of(std::string_view("Exif\0\0", 6));
    const Bytes notes = foreign_exif(1, space);
    exif.insert(exif.end(), notes.begin(), notes.end());
    const Bytes jpeg = foreign_jpeg(9, 7, 3, false);
    const Image stored = decode_image(jpeg, "a", ColorEncoding::linear);
    expect_colors(
        decode_image(with_jpeg_segment(jpeg, 0xE1, exif), "a"),
        [&](int x, int y) {
          Color light{};
          for (std::size_t c = 0; c < 3; ++c)
            light[c] = std::pow(static_cast<double>(stored.at(x, y)[c]), 563.0 / 256.0);
          return Color{std::max(1.39836 * light[0] - 0.39836 * light[1], 0.0), light[1],
                       std::max(-0.04293 * light[1] + 1.04293 * light[2], 0.0)};
        },
        2e-4);
  }
}

TEST(FileColors, ThatCannotBeFollowedAreRefusedByName) {
  const Bytes png = foreign_png(9, 7, 2, 8, false);
  const auto with = [&](const Bytes& profile) {
    return with_png_chunk(png, "iCCP", iccp_of(profile));
  };
  EXPECT_NE(refusal(with(lab_profile())).find("its ICC profile is of"), std::string::npos)
      << refusal(with(lab_profile()));
  EXPECT_NE(refusal(with(grey_profile(2.2))).find("is of GRAY, but the pixels are RGB"),
            std::string::npos);
  Bytes cut = p3_profile();
  cut.resize(200);
  EXPECT_NE(refusal(with(cut)).find("its ICC profile is damaged"), std::string::npos);
  EXPECT_EQ(refusal(with(cut), {.encoding = ColorEncoding::srgb_texture}), "was read");
  EXPECT_EQ(refusal(with(cut), {.encoding = ColorEncoding::linear}), "was read");
  // 17 MiB of zeros in 17 kB.
  EXPECT_NE(refusal(with(Bytes(std::size_t{17} << 20))).find("longer than 16 MiB"),
            std::string::npos);
  EXPECT_NE(refusal(with_png_chunk(png, "iCCP", bytes_of("name"))).find("iCCP is damaged"),
            std::string::npos);
  for (const auto& [transfer, name] : {std::pair{16, "PQ"}, std::pair{18, "HLG"}}) {
    const Bytes cicp = {std::byte{9}, static_cast<std::byte>(transfer), std::byte{0}, std::byte{1}};
    EXPECT_NE(refusal(with_png_chunk(png, "cICP", cicp)).find(name), std::string::npos);
  }
  Bytes jpeg = bytes_of(std::string_view("ICC_PROFILE\0\1\3", 14));  // the first piece of three
  jpeg = with_jpeg_segment(foreign_jpeg(9, 7, 3, false), 0xE2, jpeg);
  EXPECT_NE(refusal(jpeg).find("1 of 3 pieces"), std::string::npos) << refusal(jpeg);
}

TEST(FileColors, TakeMemoryThatIsLeft) {
  const Bytes png = with_png_chunk(foreign_png(90, 70, 2, 8, false), "iCCP", iccp_of(p3_profile()));
  MemoryBudget memory{.left = 1000};
  EXPECT_THROW((void)decode_image(png, "a", ColorEncoding::srgb, memory), FileError);
}

// A PNG whose pixels would fit, but not what its reader takes beside them, is refused before it is
// decoded: here it has none.
TEST(FileColors, OfAFileThatLeavesNoMemoryToItsReaderAreNotDecoded) {
  const Bytes whole = foreign_png(1000, 1000, 2, 8, false);
  const Bytes png(whole.begin(), whole.begin() + 60);
  MemoryBudget memory{.left = std::size_t{15} << 20};
  try {
    (void)decode_image(png, "a.png", ImageReading{.more_bytes_per_pixel = 8}, memory);
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("of memory"), std::string::npos) << error.what();
  }
}

TEST(Orientation, OfEachKindTurnsThePicture) {
  constexpr int width = 5, height = 3;
  const Bytes png = foreign_png(width, height, 2, 8, false);
  const Image stored = decode_image(png, "a", ColorEncoding::linear);
  for (int orientation = 1; orientation <= 8; ++orientation) {
    // Where the file has what is upright at x, y: TIFF 6.0 section 8, by where row 0 and column 0
    // are.
    const auto place = [&](int x, int y) -> std::pair<int, int> {
      switch (orientation) {
        case 2:
          return {width - 1 - x, y};
        case 3:
          return {width - 1 - x, height - 1 - y};
        case 4:
          return {x, height - 1 - y};
        case 5:
          return {y, x};
        case 6:
          return {y, height - 1 - x};
        case 7:
          return {width - 1 - y, height - 1 - x};
        case 8:
          return {width - 1 - y, x};
        default:
          return {x, y};
      }
    };
    Bytes exif = bytes_of(std::string_view("Exif\0\0", 6));
    const Bytes notes = foreign_exif(orientation);
    exif.insert(exif.end(), notes.begin(), notes.end());
    const std::array files = {with_png_chunk(png, "eXIf", notes),
                              foreign_tiff(width, height, {.orientation = orientation}),
                              with_jpeg_segment(foreign_jpeg(width, height, 3, false), 0xE1, exif)};
    for (const Bytes& file : files) {
      const Image image = decode_image(file, "a", ColorEncoding::linear);
      ASSERT_EQ(image.width, orientation > 4 ? height : width);
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
          const auto [column, row] = place(x, y);
          for (std::size_t c = 0; c < 3; ++c)
            ASSERT_NEAR(image.at(x, y)[c], stored.at(column, row)[c], 2.5f / 255.0f)
                << orientation << " " << x << " " << y;
        }
      MemoryBudget memory;
      const Image as_it_is = decode_image(
          file, "a", ImageReading{.encoding = ColorEncoding::linear, .is_turned_upright = false},
          memory);
      EXPECT_EQ(as_it_is.width, width);
    }
  }
}

TEST(ManyBands, OfATiffThatDeclaresNoneIsAlphaAreData) {
  const TiffKind grey{.samples = 5, .bits = 32, .is_float = true, .is_grey = true};
  for (const bool is_planar : {false, true}) {
    TiffKind kind = grey;
    kind.is_planar = is_planar;
    const Image image = decode_image(foreign_tiff(4, 3, kind), "a.tif");
    EXPECT_EQ(image.channels,
              (std::vector<std::string>{"band 1", "band 2", "band 3", "band 4", "band 5"}));
    for (std::size_t c = 0; c < 5; ++c) EXPECT_EQ(image.at(3, 2)[c], ramp(3, 2, c));
  }
  const Image color = decode_image(foreign_tiff(4, 3, {.samples = 5}), "a.tif");
  EXPECT_EQ(color.channels, (std::vector<std::string>{"R", "G", "B", "band 4", "band 5"}));
  EXPECT_NEAR(color.at(1, 1)[4], ramp(1, 1, 4), 0.003f);  // is not decoded as a color
  EXPECT_EQ(decode_image(foreign_tiff(4, 3, {.samples = 4}), "a.tif").channels.back(), "A");
}

}  // namespace
}  // namespace lamina
