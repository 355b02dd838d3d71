// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/float_within.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "lamina/base/core/random.h"

namespace lamina {
namespace {

TEST(FloatWithin, LiesInTheRangeWhateverItsEndsRoundTo) {
  Random random = make_random(3, 0);
  for (int i = 0; i < 10'000; ++i) {
    const double low = random.uniform(), high = low + 0.1 + random.uniform();
    for (const double value : {low, high, low - 1.0, high + 1.0, 0.5 * (low + high)}) {
      const float within = float_within(value, low, high);
      EXPECT_LE(low, static_cast<double>(within));
      EXPECT_LE(static_cast<double>(within), high);
      EXPECT_NEAR(static_cast<double>(within), std::clamp(value, low, high), 2.5e-7);
    }
  }
  EXPECT_LE(static_cast<double>(float_within(1.0, 0.0, 0.05)), 0.05);
  EXPECT_EQ(float_within(0.25, 0.0, 0.5), 0.25f);
}

}  // namespace
}  // namespace lamina
