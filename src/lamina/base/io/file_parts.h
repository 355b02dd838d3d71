// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "lamina/base/io/file_bytes.h"

// Files that are larger than what should be in memory.
namespace lamina {

using WritePart = std::function<void(std::span<const std::byte>)>;
using WriteParts = std::function<void(const WritePart&)>;

/// Writes a file part by part: `write_parts` hands them over in their order. What it throws
/// leaves no file.
/// @throws WriteError
void write_file_parts(const std::filesystem::path& file, const WriteParts& write_parts,
                      Lasting lasting = Lasting::power_loss);

/// A file whose parts are read where they are wanted; several threads may read.
class FileParts {
 public:
  /// @throws FileError if it is missing, no regular file, or cannot be read.
  explicit FileParts(std::filesystem::path file);
  ~FileParts();
  FileParts(const FileParts&) = delete;
  FileParts& operator=(const FileParts&) = delete;

  [[nodiscard]] std::uint64_t size() const { return size_; }

  /// Fills `bytes` from the place `at`. @throws FileError if there are not as many
  void read(std::uint64_t at, std::span<std::byte> bytes) const;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace lamina
