// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <vector>

#include "lamina/base/io/files_read.h"

namespace lamina::cli {

/// Files whose changes are waited for, by asking for their sizes and times five times a second.
class WatchedFiles {
 public:
  explicit WatchedFiles(std::vector<FileState> files) : files_(std::move(files)) {}

  /// Whether one is not as it was. Costs next to nothing between two times of asking; from any
  /// thread.
  [[nodiscard]] bool has_changed();

  /// Waits for a change, and then until nothing has changed for a tenth of a second: a file that is
  /// being written is not read half.
  void wait_for_change();

  /// The name of the first that is not as it was; "" where all are.
  [[nodiscard]] std::string name_of_changed() const;

  /// How many there are.
  [[nodiscard]] int count() const;

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<FileState> files_;
  std::atomic<bool> has_changed_ = false;
  std::atomic<Clock::time_point> next_ = Clock::time_point{};
  std::mutex asks_;
};

}  // namespace lamina::cli
