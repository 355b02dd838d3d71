// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "lamina/base/core/parallel_parts.h"
#include "lamina/base/core/stoppable_loops.h"

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

TEST(ParallelParts, TellTheMeanOfWhatEachHasFinished) {
  std::mutex mutex;
  std::vector<double> told;
  parallel_parts(
      4,
      [](std::size_t, const Progress& of_part) {
        for (const double half : {0.5, 1.0}) report_or_throw(of_part, half);
      },
      [&](double finished) {
        const std::lock_guard lock(mutex);
        told.push_back(finished);
        return true;
      });
  EXPECT_EQ(told.size(), 12u);  // the end of each part, too
  for (const double finished : told) EXPECT_EQ(finished, std::clamp(finished, 0.125, 1.0));
  EXPECT_EQ(*std::ranges::max_element(told), 1.0);
}

TEST(ParallelParts, EndWithinAPartThatIsAskedToStop) {
  std::atomic<int> steps = 0;
  EXPECT_THROW(parallel_parts(
                   1,
                   [&](std::size_t, const Progress& of_part) {
                     for (int i = 0; i < 100; ++i, ++steps) report_or_throw(of_part, 0.01 * i);
                   },
                   [](double finished) { return finished < 0.1; }),
               Interrupted);
  EXPECT_EQ(steps, 10);
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

TEST(StoppableLoops, EndLoopsOfWorkThatKnowsNoProgress) {
  std::atomic<bool> goes_on{true};
  std::atomic<int> calls{0};
  const Progress progress = [&](double) { return goes_on.load(); };
  const auto work = [&] {
    parallel_for(100, [&](std::size_t) {
      parallel_for(100, [&](std::size_t) {
        if (++calls == 50) goes_on = false;
      });
    });
  };
  {
    const std::function<void()> ask = [&] { report_or_throw(progress, 0.0); };
    const StoppableLoops loops(ask);
    EXPECT_THROW(work(), Interrupted);
  }
  EXPECT_LT(calls, 100 * 100);
  calls = 0;
  work();  // nobody is asked any more, in no thread
  EXPECT_EQ(calls, 100 * 100);
}

}  // namespace
}  // namespace lamina
