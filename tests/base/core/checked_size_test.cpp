// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/checked_size.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

namespace lamina {
namespace {

constexpr std::size_t most = std::numeric_limits<std::size_t>::max();

template <class Work>
std::string refusal(const Work& work) {
  try {
    return std::to_string(work());
  } catch (const InvalidInput& error) {
    return error.what();
  }
}

TEST(CheckedSize, CountsUpToTheLargestSize) {
  EXPECT_EQ(checked_product("it", {}), 1U);
  EXPECT_EQ(checked_product("it", {3, 5, 8}), 120U);
  EXPECT_EQ(checked_product("it", {most, 1}), most);
  EXPECT_EQ(checked_product("it", {most / 5, 5}), most);  // 2^64 - 1 is a multiple of 5
  EXPECT_EQ(checked_sum("it", {}), 0U);
  EXPECT_EQ(checked_sum("it", {most - 7, 3, 4}), most);
}

TEST(CheckedSize, OfNothingIsNothingHoweverLargeTheRest) {
  EXPECT_EQ(checked_product("it", {most, most, 0}), 0U);
}

TEST(CheckedSize, ThatWouldWrapAroundIsRefusedByName) {
  const std::size_t half = std::size_t{1} << 32;
  EXPECT_EQ(refusal([&] {
              return checked_product("the grid of r and z", {half, half, 8});
            }),
            "the grid of r and z is too large: 4294967296 x 4294967296 x 8 is more than this "
            "machine can count");
  EXPECT_EQ(refusal([&] {
              return checked_product("it", {most / 5 + 1, 5});
            }).substr(0, 16),
            "it is too large:");
  EXPECT_EQ(refusal([&] {
              return checked_sum("the file", {most, 1});
            }),
            "the file is too large: 18446744073709551615 + 1 is more than this machine can count");
}

}  // namespace
}  // namespace lamina
