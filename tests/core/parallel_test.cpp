// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace lamina {
namespace {

TEST(ParallelFor, CallsItsBodyOnceForEach) {
  std::vector<std::atomic<int>> calls(1000);
  parallel_for(calls.size(), [&](std::size_t i) { ++calls[i]; });
  for (const auto& count : calls) EXPECT_EQ(count, 1);
}

TEST(ParallelFor, ThrowsWhatItsBodyThrows) {
  EXPECT_THROW(parallel_for(100,
                            [](std::size_t i) {
                              if (i == 37) throw std::runtime_error("37");
                            }),
               std::runtime_error);
}

// Else what is read from it afterwards is not there.
TEST(ParallelFor, EndsALoopWithinAnotherThatIsGivenUp) {
  constexpr int inner = 64;
  std::atomic<int> begun = 0, half_done = 0;
  for (int round = 0; round < 20; ++round)
    EXPECT_THROW(parallel_for(16,
                              [&](std::size_t i) {
                                if (i == 1) {
                                  std::this_thread::sleep_for(std::chrono::milliseconds(1));
                                  throw std::runtime_error("1");
                                }
                                ++begun;
                                std::atomic<int> calls = 0;
                                parallel_for(inner, [&](std::size_t) {
                                  std::this_thread::sleep_for(std::chrono::microseconds(50));
                                  ++calls;
                                });
                                if (calls != inner) ++half_done;
                              }),
                 std::runtime_error);
  EXPECT_GT(begun, 0);
  EXPECT_EQ(half_done, 0);
}

}  // namespace
}  // namespace lamina
