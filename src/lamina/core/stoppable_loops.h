// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "lamina/core/progress.h"

namespace lamina {

/// While it lives: all parallel loops that this thread begins, and loops within them, ask
/// `progress` before each call of their body and end by Interrupted where it says so. For callers
/// of work that knows no Progress and has nothing to hand over before its end; what they call must
/// leave nothing half done behind an exception.
class StoppableLoops {
 public:
  /// @param progress  must outlive it
  explicit StoppableLoops(const Progress& progress);
  ~StoppableLoops();

 private:
  struct Check;
  std::unique_ptr<Check> check_;
};

}  // namespace lamina
