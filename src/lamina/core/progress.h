// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace lamina {

/// Told the finished fraction of the work, in [0, 1], now and then and from any thread.
/// Returns false to ask the work to stop early and hand over what it has. May be empty.
using Progress = std::function<bool(double finished)>;

/// Reports to `progress` if there is one.
[[nodiscard]] inline bool report(const Progress& progress, double finished) {
  return !progress || progress(finished);
}

}  // namespace lamina
