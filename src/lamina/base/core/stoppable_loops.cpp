// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/stoppable_loops.h"

namespace lamina {
namespace {

thread_local const std::function<void()>* asked_by_loops = nullptr;

}  // namespace

const std::function<void()>* function_of_loops() { return asked_by_loops; }

StoppableLoops::StoppableLoops(const std::function<void()>& ask) : former_(asked_by_loops) {
  asked_by_loops = &ask;
}

StoppableLoops::~StoppableLoops() { asked_by_loops = former_; }

}  // namespace lamina
