// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/parallel_parts.h"

#include <algorithm>
#include <atomic>

#include "lamina/base/core/parallel.h"

namespace lamina {

void parallel_parts(std::size_t count,
                    const std::function<void(std::size_t, const Progress& of_part)>& body,
                    const Progress& progress) {
  std::atomic<double> finished = 0.0;  // the sum of the fractions of all parts
  parallel_for(count, [&](std::size_t i) {
    std::atomic<double> of_this = 0.0;
    const Progress of_part = [&](double fraction) {
      finished += fraction - of_this.exchange(fraction);
      return report_progress(progress, std::clamp(finished / static_cast<double>(count), 0.0, 1.0));
    };
    body(i, of_part);
    report_or_throw(of_part, 1.0);
  });
}

}  // namespace lamina
