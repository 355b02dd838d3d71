// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

namespace lamina {

/// State of a file, told from other states of it.
struct FileState {
  std::filesystem::path file;
  bool is_there = false;
  std::uintmax_t size = 0;  ///< [bytes]
  std::uintmax_t node = 0;  ///< another one where a file was put in the place of the last
  std::int64_t changed_nanoseconds = 0;  ///< since 1970
  bool operator==(const FileState&) const = default;
};

[[nodiscard]] FileState state_of(const std::filesystem::path& file);

/// While it lives: which files this thread reads by read_file_bytes and read_stream_bytes, or looks
/// for in vain, each as it was just before. The last one made on a thread is told, and at its end
/// tells the one before.
class FilesRead {
 public:
  FilesRead();
  ~FilesRead();
  FilesRead(const FilesRead&) = delete;
  FilesRead& operator=(const FilesRead&) = delete;

  [[nodiscard]] std::vector<FileState> files() const;

 private:
  friend void note_file(const std::filesystem::path& file);
  std::map<std::filesystem::path, FileState> files_;
  FilesRead* outer_;
};

/// Tells the FilesRead of this thread, if there is one, that a file is looked for.
void note_file(const std::filesystem::path& file);

}  // namespace lamina
