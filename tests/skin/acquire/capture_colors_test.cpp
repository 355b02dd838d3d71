// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Photographs have the colors, the side up and the bands that their files say.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "base/image/png_chunk.h"
#include "base/image/scratch_folder.h"
#include "lamina/base/image/color_space.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/spectrum/rgb_encoding.h"
#include "lamina/base/spectrum/rgb_space.h"
#include "lamina/skin/acquire/capture.h"
#include "lamina/skin/acquire/files/capture_file.h"

namespace lamina {
namespace {

class CaptureColors : public ScratchFolder {
 protected:
  [[nodiscard]] Capture capture_of(const std::string& images, const std::string& more = "") const {
    std::ofstream(path("capture.json"))
        << R"({ "lamina": "capture", "version": 1, "images": [ )" << images << " ]" << more << " }";
    return develop_capture(load_capture(path("capture.json")));
  }

  static Image skin() {
    Image image = make_image(6, 4, {"R", "G", "B"});
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 6; ++x) {
        const auto step = 0.01f * static_cast<float>(x + y);
        image.at(x, y)[0] = 0.42f + step;
        image.at(x, y)[1] = 0.24f + step;
        image.at(x, y)[2] = 0.17f + step;
      }
    return image;
  }
};

TEST_F(CaptureColors, OfDisplayP3AreThoseThatSrgbShows) {
  save_png(skin(), path("srgb.png"));
  const Image p3 =
      converted_colors(skin(), rgb_conversion(rec709_primaries(), display_p3_primaries()));
  write_png_with_chunk(path("p3.png"), encode_png(p3), display_p3_chunk);
  const auto reflectances = [&](const std::string& name, const std::string& encoding) {
    return capture_of("{ \"image\": \"" + name + "\", \"encoding\": \"" + encoding +
                      "\", \"sensor\": \"srgb\" }")
        .reflectance.pixels;
  };
  const std::vector<float> right = reflectances("srgb.png", "srgb");
  float farthest = 0.0f;
  for (const char* encoding : {"srgb", "srgb_displayp3"}) {
    const std::vector<float> found = reflectances("p3.png", encoding);
    for (std::size_t i = 0; i < right.size(); ++i) EXPECT_NEAR(found[i], right[i], 0.006f);
  }
  const std::vector<float> wrong = reflectances("p3.png", "srgb_texture");  // what a user says wins
  for (std::size_t i = 0; i < right.size(); ++i)
    farthest = std::max(farthest, std::abs(wrong[i] - right[i]));
  EXPECT_GT(farthest, 0.02f);
}

TEST_F(CaptureColors, ComeWithTheSideUpThatTheCameraNotes) {
  const std::vector<std::byte> png = encode_png(skin());
  write_png_with_chunk(path("skin.png"), png, orientation_chunk(6));
  Image mask = make_image(4, 6, {"Y"});  // of the upright picture
  for (float& used : mask.pixels) used = 1.0f;
  mask.at(3, 0)[0] = 0.0f;
  save_png(mask, path("mask.png"));
  const Capture capture =
      capture_of(R"({ "image": "skin.png", "encoding": "srgb", "sensor": "srgb" })",
                 R"(, "mask": "mask.png")");
  ASSERT_EQ(capture.reflectance.width, 4);
  EXPECT_NEAR(capture.reflectance.at(3, 0)[0], skin().at(0, 0)[0], 0.004f);
  EXPECT_NEAR(capture.reflectance.at(3, 5)[0], skin().at(5, 0)[0], 0.004f);
  EXPECT_FALSE(capture.mask.is_used(3, 0));
  EXPECT_TRUE(capture.mask.is_used(0, 0));
}

/// A TIFF of gray, 32 bit floats, and samples that nobody declares. Source: TIFF 6.0, section 2.
std::string tiff_of(int width, int height, const std::vector<float>& samples) {
  std::string text("II*\0", 4), data;
  const auto put = [](std::string& to, std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) to += static_cast<char>(value >> (8 * i));
  };
  for (int i = 0; i < width * height; ++i)
    data.append(reinterpret_cast<const char*>(samples.data()), samples.size() * sizeof(float));
  const auto count = static_cast<std::uint32_t>(samples.size());
  const auto size = static_cast<std::uint32_t>(data.size());
  constexpr std::uint32_t entries = 10;
  const std::uint32_t lists = 8 + size + 2 + 12 * entries + 4;
  put(text, 8 + size, 4);
  text += data;
  put(text, entries, 2);
  const auto entry = [&](std::uint32_t tag, std::uint32_t type, std::uint32_t values,
                         std::uint32_t value) {
    put(text, tag, 2), put(text, type, 2), put(text, values, 4), put(text, value, 4);
  };
  constexpr std::uint32_t word = 3, number = 4;
  entry(256, word, 1, static_cast<std::uint32_t>(width));
  entry(257, word, 1, static_cast<std::uint32_t>(height));
  entry(258, word, count, lists);  // bits
  entry(259, word, 1, 1);
  entry(262, word, 1, 1);  // black is 0
  entry(273, number, 1, 8);
  entry(277, word, 1, count);
  entry(278, word, 1, static_cast<std::uint32_t>(height));
  entry(279, number, 1, size);
  entry(339, word, count, lists + 2 * count);
  put(text, 0, 4);
  for (std::uint32_t i = 0; i < count; ++i) put(text, 32, 2);
  for (std::uint32_t i = 0; i < count; ++i) put(text, 3, 2);  // floating point
  return text;
}

TEST_F(CaptureColors, OfAnImageOfManyBandsAreOneForEachWavelength) {
  const std::vector<float> reflectance = {0.2f, 0.25f, 0.28f, 0.4f, 0.45f};
  std::ofstream(path("bands.tif"), std::ios::binary) << tiff_of(5, 4, reflectance);
  const Capture capture = capture_of(R"({ "image": "bands.tif", "encoding": "linear",
        "sensor": { "wavelength_nm": [500, 545, 575, 630, 660] } })");
  EXPECT_EQ(capture.reflectance.channels,
            (std::vector<std::string>{"500nm", "545nm", "575nm", "630nm", "660nm"}));
  for (std::size_t c = 0; c < 5; ++c) EXPECT_EQ(capture.reflectance.at(4, 3)[c], reflectance[c]);
}

}  // namespace
}  // namespace lamina
