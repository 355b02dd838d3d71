// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/zero_signs.h"

#include <gtest/gtest.h>

namespace lamina {
namespace {

TEST(ZeroSigns, GoFromNumbersThatAreRoundedToZeroOnly) {
  EXPECT_EQ(without_negative_zeros("-0.00000"), " 0.00000");
  EXPECT_EQ(without_negative_zeros("a  -0.00  -0.01\n-0 (-0, -0.0) -0."),
            "a   0.00  -0.01\n 0 ( 0,  0.0)  0.");
  for (const char* kept : {"-0.001", "-00.5", "1-0", "x-0.0", "--0", "-0x1", "-0.0e-3",
                           "2026-01-00", "-", "- 0", "-.5"})
    EXPECT_EQ(without_negative_zeros(kept), kept);
}

}  // namespace
}  // namespace lamina
