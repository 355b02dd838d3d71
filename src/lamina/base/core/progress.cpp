// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/progress.h"

#include <atomic>

#include "lamina/base/core/parallel.h"

namespace lamina {

Progress part_of(const Progress& progress, double begin, double end) {
  if (!progress) return {};
  return [progress, begin, end](double finished) {
    return progress(begin + (end - begin) * finished);
  };
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body,
                  const Progress& progress) {
  std::atomic<std::size_t> finished = 0;
  parallel_for(count, [&](std::size_t i) {
    body(i);
    report_or_throw(progress, static_cast<double>(++finished) / static_cast<double>(count));
  });
}

}  // namespace lamina
