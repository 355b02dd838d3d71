// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace lamina {

/// All bytes of a file. @throws FileError if it is missing, a folder, or cannot be read.
[[nodiscard]] std::vector<std::byte> read_file_bytes(const std::filesystem::path& file);

/// Writes a file whole or not at all: beside its place first, then renamed. Links are followed.
/// @throws WriteError
void write_file_bytes(const std::filesystem::path& file, std::span<const std::byte> bytes);

}  // namespace lamina
