// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/plot/picture_sheet.h"

#include <gtest/gtest.h>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"

namespace lamina {
namespace {

Image uniform(int width, int height, float value) {
  Image image = make_image(width, height, {"R", "G", "B"});
  for (float& number : image.pixels) number = value;
  return image;
}

/// Decodes by the table of RFC 4648, digit by digit.
std::vector<std::byte> from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::byte> bytes;
  unsigned bits = 0, count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<unsigned>(digits.find(c));
    if ((count += 6) >= 8) bytes.push_back(static_cast<std::byte>(bits >> (count -= 8) & 0xffu));
  }
  return bytes;
}

TEST(PictureSheet, HoldsThePicturesAsTheyAre) {
  for (const int width : {1, 2, 3, 4}) {  // all lengths of the last group
    const Image picture = uniform(width, 3, 0.25f);
    const std::string svg = format_sheet("a < b", {{"one", picture}, {"two", picture}}, 2);
    EXPECT_NE(svg.find("a &lt; b"), std::string::npos);
    const std::string mark = "base64,";
    const std::size_t start = svg.find(mark) + mark.size();
    const auto bytes = from_base64(svg.substr(start, svg.find('"', start) - start));
    EXPECT_EQ(bytes, encode_png(picture));
    EXPECT_NE(svg.find(mark, start), std::string::npos);
  }
}

TEST(DifferenceMap, IsWhiteWhereEqualRedWhereBrighterBlueWhereDarker) {
  Image render = uniform(3, 1, 1.0f);
  for (int c = 0; c < 3; ++c) {
    render.at(1, 0)[c] = 1.3f;
    render.at(2, 0)[c] = 0.7f;
  }
  const Image map = difference_map(render, uniform(3, 1, 1.0f), 0.2);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(map.at(0, 0)[c], 1.0f, 1e-6f);
  EXPECT_GT(map.at(1, 0)[0], 10.0f * map.at(1, 0)[2] + 0.1f);
  EXPECT_GT(map.at(2, 0)[2], 10.0f * map.at(2, 0)[0] + 0.1f);
  const Image slight = difference_map(render, uniform(3, 1, 1.0f), 3.0);
  EXPECT_GT(slight.at(1, 0)[2], 0.5f);
  EXPECT_THROW((void)difference_map(render, uniform(2, 1, 1.0f), 0.2), InvalidInput);
}

}  // namespace
}  // namespace lamina
