// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/color_space.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include "base/image/scratch_folder.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"

namespace lamina {
namespace {

Image one_pixel(std::vector<std::string> channels, std::vector<float> values) {
  Image image = make_image(1, 1, std::move(channels));
  image.pixels = std::move(values);
  return image;
}

constexpr auto exact = ExrPrecision::single_float;

class ColorSpace : public ScratchFolder {};

TEST_F(ColorSpace, OfAFileIsSaidInIt) {
  save_exr(one_pixel({"R", "G", "B"}, {1, 0, 0}), path("aces.exr"), exact, {}, RgbSpace::acescg);
  const Imf::InputFile file(path("aces.exr").c_str());
  const Imf::Chromaticities said = Imf::chromaticities(file.header());
  EXPECT_FLOAT_EQ(said.red.x, 0.713f);
  EXPECT_FLOAT_EQ(said.blue.y, 0.044f);
  EXPECT_FLOAT_EQ(said.white.y, 0.33767f);
  const Image raw = load_image(path("aces.exr"), ColorEncoding::linear);  // numbers as they are
  EXPECT_NEAR(raw.pixels[*channel_index(raw, "R")], 0.613097f, 2e-5f);
  EXPECT_NEAR(raw.pixels[*channel_index(raw, "G")], 0.070194f, 2e-5f);
  EXPECT_NEAR(raw.pixels[*channel_index(raw, "B")], 0.020616f, 2e-5f);
}

// The layers of a picture are colors, too; alpha, normals and mattes are not.
TEST_F(ColorSpace, IsThatOfAllColorsAndOfNothingElse) {
  const Image image = one_pixel(
      {"R", "G", "B", "A", "light.sun.R", "light.sun.G", "light.sun.B", "normal.X", "normal.Y",
       "normal.Z", "CryptoObject00.R", "CryptoObject00.G", "CryptoObject00.B", "CryptoObject00.A"},
      {.8f, .2f, .1f, .5f, .1f, .7f, .3f, .6f, 0, .8f, 1e-9f, .75f, 3e8f, .25f});
  save_exr(image, path("layers.exr"), exact, {}, RgbSpace::acescg);
  const Image raw = load_image(path("layers.exr"), ColorEncoding::linear);
  const Image back = load_image(path("layers.exr"), of_colors(ColorEncoding::linear));
  EXPECT_EQ(back.pixels, load_image(path("layers.exr")).pixels);
  const auto is_color = [](const std::string& name) {
    return name.size() == 1 ? name != "A" : name.starts_with("light");
  };
  for (std::size_t c = 0; c < image.channel_count(); ++c) {
    const std::string& name = image.channels[c];
    EXPECT_NEAR(back.pixels[*channel_index(back, name)], image.pixels[c], 1e-6f) << name;
    if (is_color(name))
      EXPECT_GT(std::abs(raw.pixels[*channel_index(raw, name)] - image.pixels[c]), 1e-3f) << name;
    else
      EXPECT_EQ(raw.pixels[*channel_index(raw, name)], image.pixels[c]) << name;
  }
}

// The green of AP1 lies beyond Rec.709; a map of light must not become negative by that.
TEST_F(ColorSpace, BeyondRec709LosesWhatIsNegative) {
  const Matrix3 conversion = rgb_conversion(primaries_of(RgbSpace::acescg), rec709_primaries());
  const Image green = one_pixel({"R", "G", "B"}, {0, 1, 0});
  EXPECT_LT(converted_colors(green, conversion).pixels[0], -0.1f);
  const Image kept = converted_colors(green, conversion, Negative::none);
  EXPECT_EQ(kept.pixels[0], 0.0f);
  EXPECT_NEAR(kept.pixels[1], 1.1408f, 1e-3f);
  const Image difference = one_pixel({"R", "G", "B"}, {-1, 1, 0});  // negative before
  EXPECT_LT(converted_colors(difference, conversion, Negative::none).pixels[0], -1.0f);
}

TEST_F(ColorSpace, WithoutSenseIsRefused) {
  for (const float y : {0.0f, std::numeric_limits<float>::quiet_NaN()}) {
    Imf::Header header(1, 1);
    Imf::addChromaticities(header, {{.64f, .33f}, {.3f, .6f}, {.15f, .06f}, {.3127f, y}});
    for (const char* name : {"R", "G", "B"})
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    float value = 1.0f;
    Imf::FrameBuffer buffer;
    for (const char* name : {"R", "G", "B"})
      buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&value), 4, 4));
    {
      Imf::OutputFile file(path("none.exr").c_str(), header);
      file.setFrameBuffer(buffer);
      file.writePixels(1);
    }
    EXPECT_THROW((void)load_image(path("none.exr")), FileError) << y;
    EXPECT_EQ(load_image(path("none.exr"), ColorEncoding::linear).pixels[0], 1.0f);
  }
}

}  // namespace
}  // namespace lamina
