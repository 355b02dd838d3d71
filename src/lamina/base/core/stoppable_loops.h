// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace lamina {

/// Function that a StoppableLoops of this thread has its parallel loops call; null: none.
[[nodiscard]] const std::function<void()>* function_of_loops();

/// While it lives: all parallel loops that this thread begins, and loops within them, call a
/// function before each call of their body, which may throw, as of report_or_throw, and so end
/// them. For callers of work that knows no Progress and has nothing to hand over before its end;
/// what they call must leave nothing half done behind an exception.
class StoppableLoops {
 public:
  /// @param ask  must outlive it
  explicit StoppableLoops(const std::function<void()>& ask);
  StoppableLoops(const StoppableLoops&) = delete;
  StoppableLoops& operator=(const StoppableLoops&) = delete;
  ~StoppableLoops();

 private:
  const std::function<void()>* former_;
};

}  // namespace lamina
