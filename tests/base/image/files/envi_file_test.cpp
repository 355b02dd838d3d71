// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/envi_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>

#include "base/image/scratch_folder.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/reading_warnings.h"

namespace lamina {
namespace {

constexpr int cube_width = 5, cube_height = 4, cube_bands = 3;
double number_at(int x, int y, int band) { return x + 10 * y + 100 * band; }

template <class T>
void append(std::string& bytes, double value, bool is_big_endian) {
  auto number = std::bit_cast<std::array<char, sizeof(T)>>(static_cast<T>(value));
  if (is_big_endian) std::ranges::reverse(number);
  bytes.append(number.data(), number.size());
}

class EnviFile : public ScratchFolder {
 protected:
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
  }

  static std::string header(const std::string& changed = {}, const std::string& to = {}) {
    std::string text =
        "ENVI\n; by hand\ndescription = {\n  two lines,\n  of text}\nsamples = 5\nlines = 4\n"
        "Bands = 3\nheader offset = 2\nfile type = ENVI Standard\ndata type = 12\n"
        "interleave = bsq\nbyte order = 0\nwavelength units = Micrometers\n"
        "wavelength = {.54, 0.6,\n .655}\r\nreflectance scale factor = 100\n";
    if (const std::size_t at = text.find(changed); !changed.empty())
      text.replace(at, changed.size(), to);
    return text;
  }

  /// A cube in any layout, beside its header.
  void write_cube(const std::string& interleave, int type, bool is_big_endian) const {
    std::string text = header("data type = 12", "data type = " + std::to_string(type));
    text.replace(text.find("bsq"), 3, interleave);
    text.replace(text.find("byte order = 0"), 14,
                 is_big_endian ? "byte order = 1" : "byte order = 0");
    write("cube.hdr", text);
    std::string bytes = "??";
    const auto add = [&](int x, int y, int band) {
      const double value = number_at(x, y, band);
      if (type == 1) append<std::uint8_t>(bytes, value, is_big_endian);
      if (type == 2) append<std::int16_t>(bytes, -value, is_big_endian);
      if (type == 3) append<std::int32_t>(bytes, -value, is_big_endian);
      if (type == 4) append<float>(bytes, value, is_big_endian);
      if (type == 5) append<double>(bytes, value, is_big_endian);
      if (type == 12) append<std::uint16_t>(bytes, value, is_big_endian);
      if (type == 13) append<std::uint32_t>(bytes, value, is_big_endian);
    };
    const auto all = [](int count, const std::function<void(int)>& body) {
      for (int i = 0; i < count; ++i) body(i);
    };
    if (interleave == "bsq")
      all(cube_bands, [&](int b) {
        all(cube_height, [&](int y) { all(cube_width, [&](int x) { add(x, y, b); }); });
      });
    if (interleave == "bil")
      all(cube_height, [&](int y) {
        all(cube_bands, [&](int b) { all(cube_width, [&](int x) { add(x, y, b); }); });
      });
    if (interleave == "bip")
      all(cube_height, [&](int y) {
        all(cube_width, [&](int x) { all(cube_bands, [&](int b) { add(x, y, b); }); });
      });
    write("cube.raw", bytes);
  }

  /// The message of a header that is refused.
  static std::string refusal(const std::string& text) {
    try {
      (void)parse_envi_header(text, "a.hdr");
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(EnviFile, IsReadInEveryLayout) {
  for (const std::string interleave : {"bsq", "bil", "bip"})
    for (const int type : {1, 2, 3, 4, 5, 12, 13})
      for (const bool is_big_endian : {false, true}) {
        write_cube(interleave, type, is_big_endian);
        const Image image = load_image(path("cube.hdr"));
        ASSERT_EQ(image.width, cube_width);
        ASSERT_EQ(image.height, cube_height);
        ASSERT_EQ(image.channels, (std::vector<std::string>{"540nm", "600nm", "655nm"}));
        const double sign = type == 2 || type == 3 ? -1.0 : 1.0;
        for (int y = 0; y < cube_height; ++y)
          for (int x = 0; x < cube_width; ++x)
            for (int b = 0; b < cube_bands; ++b) {
              const double value =
                  type == 1 ? std::fmod(number_at(x, y, b), 256.0) : sign * number_at(x, y, b);
              ASSERT_FLOAT_EQ(image.at(x, y)[b], static_cast<float>(value / 100.0))
                  << interleave << " " << type;
            }
      }
}

TEST_F(EnviFile, GivesPartsOfItself) {
  for (const std::string interleave : {"bsq", "bil", "bip"}) {
    write_cube(interleave, 12, false);
    MemoryBudget memory;
    const Image image = load_envi(
        path("cube.hdr"),
        {.bands = {{650.0}, {600.0, EnviBandShape::box, 130.0}, {541.0, EnviBandShape::box, 1.0}},
         .rectangle = PixelRectangle{1, 2, 3, 2}},
        memory);
    EXPECT_EQ(image.channels, (std::vector<std::string>{"655nm", "600nm", "541nm"}));
    ASSERT_EQ(image.width, 3);
    ASSERT_EQ(image.height, 2);
    EXPECT_FLOAT_EQ(image.at(2, 1)[0], static_cast<float>(number_at(3, 3, 2) / 100.0));
    // Neighbours are 60, 57.5 and 55 nm from each other.
    const double mean =
        (60.0 * number_at(3, 3, 0) + 57.5 * number_at(3, 3, 1) + 55.0 * number_at(3, 3, 2)) /
        172.5 / 100.0;
    EXPECT_NEAR(image.at(2, 1)[1], mean, 1e-6);
    EXPECT_FLOAT_EQ(image.at(2, 1)[2], static_cast<float>(number_at(3, 3, 0) / 100.0));
    EXPECT_EQ(MemoryBudget{}.left - memory.left, image.pixels.size() * sizeof(float));
  }
}

// A Gaussian of full width w leaves a straight line as it is, and bends a parabola by w^2 / (8 ln
// 2).
TEST(EnviBands, AreMeansByAGaussian) {
  EnviHeader header{.samples = 1, .lines = 1};
  for (double nm = 500.0; nm < 700.0; nm += nm < 600.0 ? 1.0 : 2.0)
    header.wavelengths.push_back(nm);
  header.bands = header.wavelengths.size();
  const auto [bands, weights] =
      envi_band_weights(header, {600.0, EnviBandShape::gaussian, 30.0}, "a.hdr");
  double line = 0.0, parabola = 0.0;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    line += weights[i] * header.wavelengths[bands[i]];
    parabola += weights[i] * std::pow(header.wavelengths[bands[i]] - 600.0, 2);
  }
  EXPECT_NEAR(line, 600.0, 0.05);
  EXPECT_NEAR(parabola, 900.0 / (8.0 * std::log(2.0)), 0.5);
}

TEST_F(EnviFile, HasNoNumbersWhereThereAreNoData) {
  write_cube("bil", 12, false);
  write("cube.hdr", header("bsq", "bil") + "data ignore value = 102\nbbl = {1, 0, 1}\n");
  const Image image = load_image(path("cube.hdr"));
  EXPECT_EQ(image.channels, (std::vector<std::string>{"540nm", "655nm"}));
  write("cube.hdr", header("bsq", "bil") + "data ignore value = 202\n");
  EXPECT_TRUE(std::isnan(load_image(path("cube.hdr")).at(2, 0)[2]));
}

TEST_F(EnviFile, NamesBandsWithoutWavelengths) {
  std::string text =
      header("wavelength = {.54, 0.6,\n .655}\r\n", "band names = {red, green , x, }\n");
  EXPECT_NE(refusal(text).find("each of the 3 bands, but has 4"), std::string::npos);
  text = header("wavelength = {.54, 0.6,\n .655}\r\n", "band names = {red, far red , }\n");
  const EnviHeader named = parse_envi_header(text, "a.hdr");
  EXPECT_EQ(envi_channel_name(named, 1), "far red");
  EXPECT_EQ(envi_channel_name(named, 2), "band 3");
  EXPECT_THROW((void)envi_band_weights(named, {540.0}, "a.hdr"), InvalidInput);
}

TEST_F(EnviFile, ThatLeavesOutByteOrderOrUnitsIsReadWithAWarning) {
  std::vector<std::string> told;
  tell_reading_warnings([&](const std::string& text) { told.push_back(text); });
  const EnviHeader order = parse_envi_header(header("byte order = 0", ""), "a.hdr");
  EXPECT_FALSE(order.is_big_endian);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_NE(told[0].find("a.hdr: does not say its byte order"), std::string::npos);
  for (const auto& [from, to] :
       {std::pair{"wavelength units = Micrometers", ""}, std::pair{"Micrometers", "Unknown"}}) {
    told.clear();
    const EnviHeader units = parse_envi_header(header(from, to), to);
    EXPECT_DOUBLE_EQ(units.wavelengths[0], 540.0);
    ASSERT_EQ(told.size(), 1U);
    EXPECT_NE(told[0].find("0.54 to 0.655 are taken for micrometers"), std::string::npos)
        << told[0];
  }
  std::string text = header("wavelength units = Micrometers", "");
  text.replace(text.find(".54, 0.6"), 8, "540, 600");
  text.replace(text.find(".655}"), 5, "655 }");
  EXPECT_EQ(parse_envi_header(text, "b.hdr").wavelengths[2], 655.0);
  EXPECT_NE(told.back().find("are taken for nanometers"), std::string::npos) << told.back();
  tell_reading_warnings(nullptr);
}

TEST_F(EnviFile, IsRefusedWhereItCannotBeRead) {
  EXPECT_EQ(refusal(header()), "");
  const std::vector<std::array<std::string, 3>> bad = {
      {"samples = 5", "samples = -5", "samples must be a whole number"},
      {"samples = 5", "", "samples is missing"},
      {"lines = 4", "lines = 4.5", "lines must be"},
      {"data type = 12", "data type = 6", "data type must be 1, 2,"},
      {"bsq", "tiles", "interleave must be"},
      {"byte order = 0", "byte order = 2", "byte order must be a whole number from 0 to 1"},
      {"Micrometers", "Wavenumber", "wavelength units must be Nanometers or Micrometers, but is W"},
      {".54, 0.6", ".54, nan", "wavelength must be a number"},
      {".54, 0.6", ".54", "one value for each of the 3 bands, but has 2"},
      {"655}", "655", "a.hdr:15: wavelength has no closing }"},
      {"factor = 100", "factor = 0", "reflectance scale factor must be > 0"},
      {"lines = 4", "samples = 4", "a.hdr:7: samples is there twice"},
      {"lines = 4", "lines", "a.hdr:7: must be KEY = VALUE"},
      {"ENVI Standard", "TIFF", "file type must be ENVI"}};
  for (const auto& [changed, to, message] : bad)
    EXPECT_NE(refusal(header(changed, to)).find(message), std::string::npos)
        << refusal(header(changed, to));

  write("cube.hdr", header());
  EXPECT_THROW((void)load_image(path("cube.hdr")), FileError);  // alone
  write("cube.raw", std::string(121, '\0'));
  EXPECT_THROW((void)load_image(path("cube.hdr")), FileError);  // a byte short
  write("cube.raw", std::string(122, '\0'));
  EXPECT_NO_THROW((void)load_image(path("cube.hdr")));
  MemoryBudget memory;
  const auto load = [&](const EnviSelection& selection) {
    (void)load_envi(path("cube.hdr"), selection, memory);
  };
  EXPECT_THROW(load({.bands = {{720.0}}}), InvalidInput);
  EXPECT_THROW(load({.bands = {{600.0, EnviBandShape::box, 0.0}}}), InvalidInput);
  EXPECT_THROW(load({.bands = {{540.0}, {541.0}}}), FileError);  // one band, twice
  EXPECT_THROW(load({.rectangle = PixelRectangle{3, 0, 3, 1}}), InvalidInput);
  memory.left = 250;
  EXPECT_THROW(load({}), FileError);
  EXPECT_THROW((void)decode_image(std::as_bytes(std::span("ENVI\n")), "a.hdr"), FileError);
}

// Photographs of leaves: bright beyond 750 nm, dark where chlorophyll absorbs.
TEST(EnviLeaf, ShowsChlorophyll) {
  const std::filesystem::path leaf =
      std::filesystem::path(LAMINA_SHARED_DATA) / "images/leaf_laurel_vnir.hdr";
  if (!std::filesystem::exists(leaf)) GTEST_SKIP() << leaf << " is not there";
  MemoryBudget memory;
  const Image image = load_envi(leaf,
                                {.bands = {{550.0, EnviBandShape::gaussian, 10.0},
                                           {675.0, EnviBandShape::gaussian, 10.0},
                                           {800.0, EnviBandShape::gaussian, 10.0}},
                                 .rectangle = PixelRectangle{60, 20, 40, 20}},
                                memory);
  std::array<double, 3> mean{};
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    mean[i % 3] += static_cast<double>(image.pixels[i]) / 800.0;
  EXPECT_GT(mean[0], 1.2 * mean[1]);
  EXPECT_GT(mean[2], 4.0 * mean[1]);
  EXPECT_LT(mean[2], 1.0);
}

}  // namespace
}  // namespace lamina
