// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <ctime>

namespace lamina {

/// CPU time of this thread so far [s].
[[nodiscard]] inline double thread_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Mean time of the calls work(0), work(1) … [CPU s]: up to `most` of them, but none begins after
/// a fiftieth of a second.
template <class Work>
[[nodiscard]] double seconds_of(std::size_t most, const Work& work) {
  const double start = thread_cpu_seconds();
  double spent = 0.0;
  std::size_t done = 0;
  while (done < most && spent < 0.02) {
    work(done++);
    spent = thread_cpu_seconds() - start;
  }
  return done > 0 ? spent / static_cast<double>(done) : 0.0;
}

}  // namespace lamina
