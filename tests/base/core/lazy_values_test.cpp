// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/lazy_values.h"

#include <gtest/gtest.h>

#include <atomic>

#include "lamina/base/core/parallel.h"

namespace lamina {
namespace {

TEST(KeptValues, AreMadeOncePerKey) {
  KeptValues<int, int> kept(3);
  int made = 0;
  const auto square = [&](int key) { return kept.at(key, [&] { return ++made, key * key; }); };
  for (int repeat = 0; repeat < 4; ++repeat)
    for (const int key : {1, 2, 3}) EXPECT_EQ(square(key), key * key);
  EXPECT_EQ(made, 3);
  EXPECT_EQ(square(4), 16);  // one more: all others are forgotten
  EXPECT_EQ(square(1), 1);
  EXPECT_EQ(square(4), 16);
  EXPECT_EQ(made, 5);
}

TEST(KeptValues, OfMakersThatFailAreNotKept) {
  KeptValues<int, int> kept(3);
  EXPECT_THROW((void)kept.at(1, []() -> int { throw 1; }), int);
  EXPECT_EQ(kept.at(1, [] { return 7; }), 7);
}

TEST(KeptValues, AreTheSameInAllThreads) {
  KeptValues<std::size_t, std::size_t> kept(64);
  std::atomic<int> wrong = 0;
  parallel_for(10000, [&](std::size_t i) {
    if (kept.at(i % 50, [&] { return 3 * (i % 50); }) != 3 * (i % 50)) ++wrong;
  });
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace lamina
