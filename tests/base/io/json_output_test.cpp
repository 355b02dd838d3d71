// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/json_output.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

TEST(JsonOutput, KeepsTheOrderInWhichKeysAreAdded) {
  JsonOutput json = {{"zenith", 1}, {"azimuth", true}};
  json["middle"] = "text";
  json["zenith"] = nullptr;
  EXPECT_EQ(json.text(), R"({"zenith":null,"azimuth":true,"middle":"text"})");
}

TEST(JsonOutput, PutsAnElementALineWhereItIndents) {
  JsonOutput json;
  json["layers"].push_back({{"g", 0.5}});
  json["layers"].push_back(JsonOutput::array());
  json["none"] = JsonOutput::object();
  EXPECT_EQ(json.text(1), R"({
 "layers": [
  {
   "g": 0.5
  },
  []
 ],
 "none": {}
})");
}

TEST(JsonOutput, TakesContainers) {
  EXPECT_EQ(JsonOutput(std::vector<double>{1.0, 2.5}).text(), "[1.0,2.5]");
  EXPECT_EQ(JsonOutput(std::set<int>{3, 1}).text(), "[1,3]");
  EXPECT_EQ(JsonOutput(std::vector<std::string>{"R"}).text(), R"(["R"])");
  EXPECT_EQ(JsonOutput(std::array<float, 2>{0.5f, 2.0f}).text(), "[0.5,2.0]");
  EXPECT_EQ(JsonOutput::array({1, "a", 0.0}).text(), R"([1,"a",0.0])");
}

TEST(JsonOutput, UpdatesInPlaceAndErases) {
  JsonOutput json = {{"a", 1}, {"b", 2}};
  json.update({{"a", 3}, {"c", 4}});
  json.erase("b");
  EXPECT_EQ(json.text(), R"({"a":3,"c":4})");
  EXPECT_EQ(json.size(), 2u);
}

TEST(JsonOutput, WritesNumbersAsShortAsTheyReadBack) {
  const std::vector<std::pair<double, std::string>> cases = {{0.0, "0.0"},
                                                             {-0.0, "-0.0"},
                                                             {1.0, "1.0"},
                                                             {0.1, "0.1"},
                                                             {-2.5, "-2.5"},
                                                             {123456.0, "123456.0"},
                                                             {1e14, "100000000000000.0"},
                                                             {1e15, "1e+15"},
                                                             {1.25e15, "1.25e+15"},
                                                             {0.001, "0.001"},
                                                             {0.0001, "0.0001"},
                                                             {0.00001, "1e-05"},
                                                             {1.5e-7, "1.5e-07"},
                                                             {1e300, "1e+300"},
                                                             {0.1 + 0.2, "0.30000000000000004"},
                                                             {5e-324, "5e-324"}};
  for (const auto& [value, text] : cases) EXPECT_EQ(JsonOutput(value).text(), text);
  EXPECT_EQ(JsonOutput(std::numeric_limits<std::uint64_t>::max()).text(), "18446744073709551615");
  EXPECT_EQ(JsonOutput(std::numeric_limits<std::int64_t>::min()).text(), "-9223372036854775808");
}

TEST(JsonOutput, NumbersReadBackTheSame) {
  rc::check([](std::uint64_t bits) {
    const auto value = std::bit_cast<double>(bits);
    RC_PRE(std::isfinite(value));
    const std::string text = JsonOutput(value).text();
    RC_ASSERT(std::strtod(text.c_str(), nullptr) == value);
    RC_ASSERT(text.find_first_of(".e") != std::string::npos);
  });
}

TEST(JsonOutput, CopiesWhatWasRead) {
  const std::string text = R"({"a":[1,1.0,-3,true,null,"x\n"],"b":{"c":1e+30,"d":{}},"e":[]})";
  EXPECT_EQ(JsonOutput(parse_json(text, "test").root()).text(), text);
}

TEST(JsonOutput, EscapesAndMendsText) {
  EXPECT_EQ(json_quoted("a\"\\\n\t\x01\x1f/é"), "\"a\\\"\\\\\\n\\t\\u0001\\u001f/é\"");
  EXPECT_EQ(json_quoted("a\xff\xc3(\xed\xa0\x80"), "\"a\uFFFD\uFFFD(\uFFFD\uFFFD\uFFFD\"");
  EXPECT_TRUE(is_utf8("\xf0\x9f\x98\x80 é"));
  EXPECT_FALSE(is_utf8("\xc0\xaf"));
  EXPECT_FALSE(is_utf8("\xf4\x90\x80\x80"));
  EXPECT_FALSE(is_utf8("\xe2\x82"));
}

TEST(JsonOutput, SaysWhereANumberIsNone) {
  JsonOutput json = {{"name", "x"}};
  EXPECT_NO_THROW(json.require_numbers());
  json["rows"].push_back({{"diffusion", 1.0}});
  json["rows"].push_back({{"diffusion", std::nan("")}});
  try {
    json.require_numbers();
    FAIL() << "was not refused";
  } catch (const WriteError& error) {
    EXPECT_STREQ(error.what(), "the result has no number, but nan, at rows[1].diffusion");
  }
}

}  // namespace
}  // namespace lamina
