// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace lamina {

/// Calls `body(i)` once for each i in [0, count), on all threads, in no particular order.
/// An exception thrown by `body` stops the loop and is thrown again here.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

/// Limits the threads of all later parallel loops in this process; 0 means all that there are.
void set_thread_count(int threads);

/// The number of threads that parallel loops use now.
[[nodiscard]] int thread_count();

}  // namespace lamina
