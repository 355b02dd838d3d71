// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/random.h"

#include <gtest/gtest.h>

#include <array>

namespace lamina {
namespace {

TEST(Random, IsUniformOverItsStreamsAndWithinThem) {
  // 100 bins, 1e6 draws: chi-square with 99 degrees of freedom; 4 standard deviations.
  for (const bool is_one_stream : {true, false}) {
    std::array<int, 100> count{};
    Random one = make_random(7, 0);
    for (int i = 0; i < 1'000'000; ++i) {
      const double u =
          is_one_stream ? one.uniform() : make_random(7, static_cast<std::uint64_t>(i)).uniform();
      ++count[static_cast<std::size_t>(100.0 * u)];
    }
    double chi2 = 0.0;
    for (const int n : count) chi2 += (n - 1e4) * (n - 1e4) / 1e4;
    EXPECT_NEAR(chi2, 99.0, 4.0 * 14.07);
  }
}

TEST(Random, RepeatsForTheSameSeedAndDiffersForAnother) {
  EXPECT_EQ(make_random(1, 5).bits(), make_random(1, 5).bits());
  EXPECT_NE(make_random(1, 5).bits(), make_random(2, 5).bits());
  EXPECT_NE(make_random(1, 5).bits(), make_random(1, 6).bits());
}

}  // namespace
}  // namespace lamina
