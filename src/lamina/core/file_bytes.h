// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace lamina {

/// All bytes of a file or pipe.
///
/// @throws FileError in one line if it is missing, a folder or device, larger than `most` bytes, or
/// cannot be read.
[[nodiscard]] std::string read_file_bytes(const std::filesystem::path& file,
                                          std::size_t most = std::size_t{4} << 30);

/// What a written file outlasts.
enum class Lasting {
  power_loss,  ///< waits until it is on the disk
  process,     ///< enough for what can be made anew, such as a cache
};

/// Writes a file whole or not at all: beside its place first, then renamed. The user's links are
/// followed, a file keeps its permissions. What processes that were killed have left in the making in the same
/// folder is removed.
/// @throws WriteError
void write_file_bytes(const std::filesystem::path& file, std::span<const std::byte> bytes,
                      Lasting lasting = Lasting::power_loss);

}  // namespace lamina
