// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "lamina/base/core/error.h"

namespace lamina {

/// Told the finished fraction of the work, in [0, 1], now and then and from any thread.
/// Returns false to ask the work to stop early. It then hands over what it has, or throws
/// Interrupted if that is nothing. May be empty.
using Progress = std::function<bool(double finished)>;

/// Work was asked to stop before it had anything to hand over.
class Interrupted : public Error {
 public:
  Interrupted() : Error("interrupted: there is no result yet") {}
};

/// Reports to `progress` if there is one.
[[nodiscard]] inline bool report_progress(const Progress& progress, double finished) {
  return !progress || progress(finished);
}

/// Reports progress of work that has nothing to hand over before its end.
/// @throws Interrupted if asked to stop
inline void report_or_throw(const Progress& progress, double finished) {
  if (!report_progress(progress, finished)) throw Interrupted();
}

/// Progress of a part of the work: all of the part is the fraction from `begin` to `end` of the
/// whole.
[[nodiscard]] Progress part_of(const Progress& progress, double begin, double end);

/// Progress of work whose length nobody knows: that it goes on, as a finished fraction of 0.
[[nodiscard]] inline Progress of_unknown_length(const Progress& progress) {
  return part_of(progress, 0.0, 0.0);
}

/// parallel_for of base/core/parallel.h for work that has nothing to hand over before its end:
/// reports after each call of `body`.
/// @throws Interrupted if asked to stop; calls of `body` that have not begun are left out
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body,
                  const Progress& progress);

}  // namespace lamina
