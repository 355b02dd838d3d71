// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace lamina {

/// Names of all that lies in a folder, in no order, "." and ".." left out; empty, with an error, if
/// it cannot be read. In place of std::filesystem's iterator, which ends the process where memory
/// is missing.
/// @throws std::bad_alloc
[[nodiscard]] std::vector<std::string> folder_names(const std::filesystem::path& folder,
                                                    std::error_code& error);

}  // namespace lamina
