// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/core/stoppable_loops.h"
#include "work.h"

namespace lamina::python {

/// The result of `work()`, without Python's lock: heard by Ctrl-C in the parallel loops of work that
/// knows no Progress. @throws what it throws; Interrupted after Ctrl-C.
template <class F>
auto heard(const F& work) {
  Work call(py::none{});
  return call.run([&](const Progress& progress) {
    const StoppableLoops loops(progress);
    return work();
  });
}

}  // namespace lamina::python
