// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace lamina::detail {

/// Function that parallel loops begun by this thread call before each call of their body; it may
/// throw. Null: none.
[[nodiscard]] const std::function<void()>* loop_check();

/// Sets the function of this thread while it lives.
class LoopCheck {
 public:
  /// @param check  must outlive it; may be null
  explicit LoopCheck(const std::function<void()>* check);
  LoopCheck(const LoopCheck&) = delete;
  LoopCheck& operator=(const LoopCheck&) = delete;
  ~LoopCheck();

 private:
  const std::function<void()>* former_;
};

}  // namespace lamina::detail
