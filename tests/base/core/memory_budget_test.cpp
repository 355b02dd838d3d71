// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/memory_budget.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

constexpr std::size_t mebi = std::size_t{1} << 20;

std::string refusal(MemoryBudget& budget, std::size_t count, std::size_t size) {
  try {
    take_memory(budget, count, size, "f.png: 3 x 5 pixels");
  } catch (const FileError& error) {
    return error.what();
  }
  return {};
}

TEST(MemoryBudget, IsTakenUntilNothingIsLeft) {
  MemoryBudget budget{.left = 10 * mebi};
  EXPECT_EQ(refusal(budget, 4, mebi), "");
  EXPECT_EQ(refusal(budget, 7, mebi),
            "f.png: 3 x 5 pixels would take 7 MiB of memory, but only 6 MiB are left of the "
            "budget (--memory-budget)");
  EXPECT_EQ(budget.left, 6 * mebi);  // what was refused is not taken
  EXPECT_EQ(refusal(budget, 6, mebi), "");
  EXPECT_EQ(budget.left, 0U);
}

TEST(MemoryBudget, OfSizesThatWrapAroundIsRefused) {
  MemoryBudget budget;
  EXPECT_NE(refusal(budget, std::numeric_limits<std::size_t>::max() / 2, 4), "");
}

TEST(MemorySize, IsWrittenAndReadWithItsUnit) {
  EXPECT_EQ(memory_size_text(99), "99 B");
  EXPECT_EQ(memory_size_text(mebi + mebi / 2), "1.5 MiB");
  EXPECT_EQ(memory_size_text(50 * 1024 * mebi), "50 GiB");
  EXPECT_EQ(parse_memory_size("99B"), 99U);
  EXPECT_EQ(parse_memory_size("1.5 MiB"), mebi + mebi / 2);
  EXPECT_EQ(parse_memory_size("4GiB"), MemoryBudget{}.left);
}

TEST(MemorySize, WithoutANumberOrUnitIsRefused) {
  for (const char* text :
       {"", "4", "GiB", "-1GiB", "0MiB", "nan GiB", "inf GiB", "4 gigabytes", "1e300TiB", "0.1B"})
    EXPECT_THROW((void)parse_memory_size(text), InvalidInput) << text;
}

}  // namespace
}  // namespace lamina
