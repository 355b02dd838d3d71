// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace lamina::cli {

/// How a program ended, and what it wrote.
struct ProgramRun {
  int exit_code = 0;  ///< 128 and more: ended by a signal
  std::string output, errors;
};

/// Runs a program, found as shells find it, in a folder, without input, and waits for its end.
/// Absent if there is no such program.
/// @throws Error if it cannot be started for another reason
[[nodiscard]] std::optional<ProgramRun> run_program(const std::vector<std::string>& words,
                                                    const std::string& folder);

/// The file of this program.
[[nodiscard]] std::string this_program();

}  // namespace lamina::cli
