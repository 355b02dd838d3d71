// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/hash.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace lamina {
namespace {

std::uint64_t hash_of(const std::string& text) {
  Hash hash;
  hash.add_text(text);
  return hash.value();
}

// Every flipped bit, every pair of them in different words, every cut: no number twice.
TEST(Hash, TellsDamagedBytesFromWholeOnes) {
  const std::string whole = "a row of bytes that is a few words long";
  std::set<std::uint64_t> seen = {hash_of(whole)};
  const auto is_new = [&](const std::string& text) { return seen.insert(hash_of(text)).second; };
  const std::size_t bits = 8 * whole.size();
  const auto flip = [](std::string& text, std::size_t bit) {
    text[bit / 8] = static_cast<char>(text[bit / 8] ^ (1 << (bit % 8)));
  };
  for (std::size_t one = 0; one < bits; ++one)
    for (std::size_t other = one; other < bits; ++other) {
      std::string damaged = whole;
      flip(damaged, one);
      if (other != one) flip(damaged, other);
      ASSERT_TRUE(is_new(damaged)) << one << ' ' << other;
    }
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_TRUE(is_new(whole.substr(0, size)));
  EXPECT_TRUE(is_new(whole + '\0'));
}

TEST(Hash, TakesEqualNumbersForEqual) {
  Hash negative, positive, other;
  negative.add(-0.0);
  positive.add(0.0);
  other.add(1.0);
  EXPECT_EQ(negative.value(), positive.value());
  EXPECT_NE(other.value(), positive.value());
}

}  // namespace
}  // namespace lamina
