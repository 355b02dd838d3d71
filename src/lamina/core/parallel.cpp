// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <memory>
#include <mutex>

namespace lamina {

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (thread_count() == 1) {  // even then oneTBB may wake a second thread
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { body(i); });
}

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

}  // namespace lamina
