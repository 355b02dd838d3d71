// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>

#include "lamina/base/core/parallel.h"
#include "lamina/base/core/progress.h"

namespace lamina {

/// parallel_for, a chunk of neighbouring i at a time: for bodies that take little time.
template <class Body>
void parallel_chunks(std::size_t count, std::size_t chunk, const Body& body) {
  parallel_for((count + chunk - 1) / chunk, [&](std::size_t c) {
    for (std::size_t i = c * chunk; i < std::min(count, (c + 1) * chunk); ++i) body(i);
  });
}

/// Runs chunks of work of unknown length: reports after each chunk.
/// @return  false if asked to stop; chunks that have not begun are left out
template <class Body>
[[nodiscard]] bool parallel_chunks(std::size_t count, std::size_t chunk, const Body& body,
                                   const Progress& progress) {
  std::atomic<bool> is_stopped = false;
  parallel_for((count + chunk - 1) / chunk, [&](std::size_t c) {
    if (is_stopped) return;
    for (std::size_t i = c * chunk; i < std::min(count, (c + 1) * chunk); ++i) body(i);
    if (!report_progress(progress, 0.0)) is_stopped = true;
  });
  return !is_stopped;
}

}  // namespace lamina
