// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/core/internal/loop_check.h"

namespace lamina::detail {
namespace {

thread_local const std::function<void()>* check_of_thread = nullptr;

}  // namespace

const std::function<void()>* loop_check() { return check_of_thread; }

LoopCheck::LoopCheck(const std::function<void()>* check) : former_(check_of_thread) {
  check_of_thread = check;
}

LoopCheck::~LoopCheck() { check_of_thread = former_; }

}  // namespace lamina::detail
