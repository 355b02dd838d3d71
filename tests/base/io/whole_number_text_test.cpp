// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/whole_number_text.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <utility>

namespace lamina {
namespace {

TEST(WholeNumberText, IsDigitsOrWhatAPersonReads) {
  for (const auto& [value, text] : {std::pair<std::int64_t, const char*>{0, "0"},
                                    {-1, "-1"},
                                    {65536, "65536"},
                                    {999'999, "999999"},
                                    {10'000'000, "1e7"},
                                    {4'000'000'000, "4e9"},
                                    {1 << 24, "2^24"},
                                    {std::int64_t{1} << 53, "2^53"},
                                    {std::numeric_limits<std::int32_t>::max(), "2^31 - 1"},
                                    {std::numeric_limits<std::int32_t>::min(), "-2^31"},
                                    {std::numeric_limits<std::int64_t>::min(), "-2^63"},
                                    {12'345'678, "12345678"}})
    EXPECT_EQ(whole_number_text(value), text);
  EXPECT_EQ(whole_number_text(std::numeric_limits<std::uint64_t>::max()), "2^64 - 1");
}

}  // namespace
}  // namespace lamina
