// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/io/json_file.h"
#include "lamina/skin/acquire/develop_capture.h"

namespace lamina {

/// Reads a capture file and its photographs, changed by settings as parse_json takes them, for
/// develop_capture; docs/acquire.md has the format.
/// @throws FileError if a file is missing or unreadable; InvalidInput naming file, line and field.
[[nodiscard]] CaptureDescription load_capture(const JsonFile& file, MemoryBudget memory = {},
                                              std::span<const std::string> settings = {});

}  // namespace lamina
