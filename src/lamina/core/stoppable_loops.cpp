// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/core/stoppable_loops.h"

#include <functional>

#include "lamina/core/internal/loop_check.h"

namespace lamina {

struct StoppableLoops::Check {
  std::function<void()> ask;
  detail::LoopCheck of_thread{&ask};
};

StoppableLoops::StoppableLoops(const Progress& progress)
    : check_(new Check{.ask = [&progress] { report_or_throw(progress, 0.0); }}) {}

StoppableLoops::~StoppableLoops() = default;

}  // namespace lamina
