// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "lamina/base/core/memory_budget.h"

namespace lamina {

/// All bytes of a file, which are taken from the budget.
///
/// @throws FileError in one line if it is missing, no regular file (a folder, a device, or a pipe,
///         for which the reader would wait), larger than what is left of the budget, or cannot be
///         read.
[[nodiscard]] std::string read_file_bytes(const std::filesystem::path& file, MemoryBudget& budget);
[[nodiscard]] std::string read_file_bytes(const std::filesystem::path& file);

/// Refuses what read_file_bytes refuses, for files that a library opens by itself.
/// @throws FileError
void require_regular_file(const std::filesystem::path& file);

/// Reads a file or a stream that is open already, standard input or <(...) of a shell, for what
/// users name themselves. Pipes with a name in a folder are refused: one that nobody writes to
/// would be waited for.
/// @throws FileError, also if there are more than `most` bytes.
[[nodiscard]] std::string read_stream_bytes(const std::filesystem::path& file, std::size_t most);

/// Events that a written file outlasts.
enum class Lasting {
  power_loss,  ///< waits until it is on the disk
  process,     ///< enough for what can be made anew, such as a cache
};

/// Writes a file whole or not at all: beside its place first, then renamed. The user's links are
/// followed, a file keeps its permissions. What processes that were killed have left in the making
/// in the same folder is removed.
/// @throws WriteError
void write_file_bytes(const std::filesystem::path& file, std::span<const std::byte> bytes,
                      Lasting lasting = Lasting::power_loss);

}  // namespace lamina
