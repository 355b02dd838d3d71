// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lamina/base/core/progress.h"

namespace lamina::cli {

/// Runs this program with other arguments in a folder, and returns what it writes for --json.
/// What it says is left in the file `log` there. It ends when `progress` asks to stop, and with
/// this process.
///
/// @throws Interrupted if asked to stop; InvalidInput with its last line if it fails.
[[nodiscard]] std::string run_this_program(const std::vector<std::string>& arguments,
                                           const std::filesystem::path& folder,
                                           const Progress& progress);

}  // namespace lamina::cli
