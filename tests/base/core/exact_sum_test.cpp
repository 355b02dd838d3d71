// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/exact_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "lamina/base/core/random.h"
#include "lamina/base/core/shard.h"

namespace lamina {
namespace {

using LightSum = ExactSum<2, 64>;

/// Of either sign and of all sizes from 2^-40 to 2^20.
std::vector<double> terms(int count) {
  Random random = make_random(3, 0);
  std::vector<double> terms;
  for (int i = 0; i < count; ++i)
    terms.push_back(static_cast<double>(static_cast<float>(
        std::ldexp(random.uniform() - 0.5, static_cast<int>(60.0 * random.uniform()) - 40))));
  return terms;
}

TEST(ExactSum, DoesNotDependOnOrderNorOnHowItIsSplit) {
  std::vector<double> all = terms(3000);
  LightSum forward, backward, parts;
  for (const double term : all) forward.add(term);
  std::ranges::reverse(all);
  for (const double term : all) backward.add(term);
  EXPECT_EQ(forward, backward);
  for (int shard = 6; shard >= 0; --shard) {
    const IndexRange range = range_of({shard, 7}, 3000);
    LightSum part;
    for (auto i = range.begin; i < range.end; ++i) part.add(all[static_cast<std::size_t>(i)]);
    parts.add(part);
  }
  EXPECT_EQ(forward, parts);
}

// A long double has 64 bits: enough for a thousand terms of a float that differ by up to 2^30.
TEST(ExactSum, IsTheSum) {
  Random random = make_random(4, 0);
  LightSum sum;
  ExactSum<3, 92> wide;
  long double literal = 0.0L;
  for (int i = 0; i < 1000; ++i) {
    const auto term = static_cast<double>(static_cast<float>(
        std::ldexp(random.uniform() - 0.4, static_cast<int>(10.0 * random.uniform()))));
    sum.add(term);
    wide.add(term);
    literal += static_cast<long double>(term);
  }
  EXPECT_EQ(sum.value(), static_cast<double>(literal));
  EXPECT_EQ(wide.value(), static_cast<double>(literal));
}

TEST(ExactSum, KeepsWhatASumOfDoublesLoses) {
  LightSum sum;
  sum.add(1e10);
  sum.add(0x1p-60);
  sum.add(-1e10);
  EXPECT_EQ(sum.value(), 0x1p-60);
  sum.add(-0x1p-60);
  EXPECT_EQ(sum, LightSum());
  sum.add(0x1p-65);  // half a step is rounded up, less is nothing
  EXPECT_EQ(sum.value(), 0x1p-64);
  sum.add(0x1p-66);
  sum.add(5e-324);
  EXPECT_EQ(sum.value(), 0x1p-64);
}

TEST(ExactSum, CutsWhatWouldNotFitSoThatItIsSeen) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const double limit = std::ldexp(1.0, LightSum::limit_exponent);
  LightSum sum;
  for (int i = 0; i < 1 << 16; ++i) sum.add(i % 2 == 0 ? infinite : 1e300);
  EXPECT_EQ(sum.value(), std::ldexp(limit, 16));
  LightSum down;
  down.add(-infinite);
  EXPECT_EQ(down.value(), -limit);
  LightSum none;
  none.add(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(std::abs(none.value()), limit);
}

TEST(Shard, DoesNeighboursAndAllOfThemDoEachOnce) {
  for (const std::int64_t all : {1, 7, 64, 1000})
    for (const int count : {1, 3, 16, 2000}) {
      std::int64_t next = 0;
      for (int i = 0; i < count; ++i) {
        const IndexRange range = range_of({i, count}, all);
        EXPECT_EQ(range.begin, next);
        EXPECT_LE(range.size(), all / count + 1);
        next = range.end;
      }
      EXPECT_EQ(next, all);
    }
}

}  // namespace
}  // namespace lamina
