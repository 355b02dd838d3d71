// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "lamina/base/core/progress.h"
#include "lamina/base/core/stoppable_loops.h"
#include "work.h"

namespace lamina::python {

/// The result of `work()`, without Python's lock: heard by Ctrl-C in the parallel loops of work
/// that knows no Progress. @throws what it throws; Interrupted after Ctrl-C.
template <class F>
auto heard(const F& work) {
  Work call(py::none{});
  return call.run([&](const Progress& progress) {
    const std::function<void()> ask = [&] { report_or_throw(progress, 0.0); };
    const StoppableLoops loops(ask);
    return work();
  });
}

}  // namespace lamina::python
