// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/cryptomatte.h"

#include <gtest/gtest.h>

#include <bit>
#include <string>
#include <vector>

#include "lamina/base/image/files/image_file.h"

namespace lamina {
namespace {

// Published vectors of MurmurHash3_x86_32 for seed 0.
TEST(Cryptomatte, HashesNamesAsMurmur3) {
  EXPECT_EQ(cryptomatte_hash(""), 0u);
  EXPECT_EQ(cryptomatte_hash("test"), 0xba6bd213u);
  EXPECT_EQ(cryptomatte_hash("Hello, world!"), 0xc0363e43u);
  EXPECT_EQ(cryptomatte_hash("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
}

TEST(Cryptomatte, IdsAreNormalNumbers) {
  EXPECT_EQ(cryptomatte_value(0x3f800000u), 1.0f);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(cryptomatte_value(0x00000001u)), 0x00800001u);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(cryptomatte_value(0xff800123u)), 0xff000123u);
}

TEST(Cryptomatte, RanksThingsByTheirCover) {
  Image image = make_image(2, 1, {"R"});
  image.pixels = {0.25f, 0.5f};
  const std::vector<std::string> names = {"head", "eye", "head"};
  const std::vector<std::vector<MatteShare>> shares = {{{0, 0.25f}, {1, 0.375f}, {2, 0.25f}}, {}};
  const std::vector<ImageNote> notes = add_cryptomatte(image, "CryptoObject", names, shares);
  ASSERT_EQ(image.channel_count(), 13u);
  EXPECT_EQ(image.channels[1], "CryptoObject00.R");
  EXPECT_EQ(image.channels[12], "CryptoObject02.A");
  const auto value = [](const char* name) { return cryptomatte_value(cryptomatte_hash(name)); };
  const std::vector<float> expected = {0.25f, value("head"), 0.5f, value("eye"), 0.375f};
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), image.pixels.begin()));
  EXPECT_EQ(image.pixels[13], 0.5f);
  EXPECT_EQ(image.pixels[14], 0.0f);
  const std::string key = notes[0].name.substr(0, notes[0].name.rfind('/') + 1);
  EXPECT_EQ(key.size(), std::string("cryptomatte/1234567/").size());
  EXPECT_EQ(notes[0].text, "CryptoObject");
  EXPECT_NE(notes[3].text.find("\"eye\":"), std::string::npos);
}

TEST(Cryptomatte, KeepsItsBitsInFiles) {
  Image image = make_image(1, 1, {"R", "G", "B"});
  const std::vector<std::string> names = {"head"};
  const std::vector<std::vector<MatteShare>> shares = {{{0, 1.0f}}};
  const std::vector<ImageNote> notes = add_cryptomatte(image, "CryptoObject", names, shares);
  const Image read = decode_image(encode_exr(image, ExrPrecision::half, notes), "matte.exr",
                                  ColorEncoding::linear);
  EXPECT_EQ(read.pixels[*channel_index(read, "CryptoObject00.R")],
            cryptomatte_value(cryptomatte_hash("head")));
}

}  // namespace
}  // namespace lamina
