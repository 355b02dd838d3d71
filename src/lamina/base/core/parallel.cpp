// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/parallel.h"

#ifdef LAMINA_THREADS
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>
#endif

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "lamina/base/core/stoppable_loops.h"

namespace lamina {

#if defined(LAMINA_THREADS) && defined(__SANITIZE_THREAD__)
namespace {

/// The sanitizer does not see into oneTBB and takes its loops for races; it knows these threads.
void run_on_own_threads(std::size_t count, const std::function<void(std::size_t)>& body) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr thrown;
  std::mutex mutex;
  const auto run = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) body(i);
    } catch (...) {
      next = count;
      const std::scoped_lock lock(mutex);
      thrown = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  const std::size_t wanted = std::min(count, static_cast<std::size_t>(thread_count()));
  while (threads.size() + 1 < wanted) threads.emplace_back(run);
  run();
  for (std::thread& thread : threads) thread.join();
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace
#endif

namespace {

void run_all(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (thread_count() == 1) {  // even then oneTBB may wake a second thread
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
#if !defined(LAMINA_THREADS)
#elif defined(__SANITIZE_THREAD__)
  run_on_own_threads(count, body);
#else
  // Isolated: else an exception in one iteration of a loop around this one would end it half done.
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::parallel_for(
      std::size_t{0}, count, [&](std::size_t i) { body(i); }, context);
#endif
}

}  // namespace

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  const std::function<void()>* const ask = function_of_loops();
  if (!ask) return run_all(count, body);
  run_all(count, [&](std::size_t i) {
    (*ask)();
    const StoppableLoops within(*ask);  // in whichever thread this is
    body(i);
  });
}

#ifdef LAMINA_THREADS
void set_thread_count(int threads) {
  static std::mutex mutex;
  static std::unique_ptr<tbb::global_control> control;
  const std::scoped_lock lock(mutex);
  control.reset();
  if (threads > 0)
    control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<std::size_t>(threads));
}

int thread_count() {
  return static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}
#else
void set_thread_count(int) {}

int thread_count() { return 1; }
#endif

}  // namespace lamina
