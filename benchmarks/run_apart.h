// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <optional>
#include <type_traits>

namespace lamina {

/// Result of `run()`, run in a process of its own, so that its peak of memory is its own. Absent
/// if that process fails. Threads do not survive a fork: the process that calls must have had none.
template <class Run>
[[nodiscard]] std::optional<std::invoke_result_t<Run>> run_apart(const Run& run) {
  using Row = std::invoke_result_t<Run>;
  static_assert(std::is_trivially_copyable_v<Row>);
  static_assert(sizeof(Row) <= 4096);  // a pipe takes that much at once
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return std::nullopt;
  const pid_t child = fork();
  if (child == 0) {
    bool is_sent = false;
    try {
      const Row row = run();
      is_sent = write(ends[1], &row, sizeof row) == sizeof row;
    } catch (...) {  // nothing of the parent may go on here
    }
    _exit(is_sent ? 0 : 1);
  }
  close(ends[1]);
  Row row;
  const bool is_read = child > 0 && read(ends[0], &row, sizeof row) == sizeof row;
  close(ends[0]);
  if (child > 0) waitpid(child, nullptr, 0);
  if (!is_read) return std::nullopt;
  return row;
}

}  // namespace lamina
