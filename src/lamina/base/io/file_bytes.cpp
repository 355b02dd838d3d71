// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/file_bytes.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <string>
#include <system_error>

#include "lamina/base/core/error.h"
#include "lamina/base/io/files_read.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

std::string reason(int error_number) { return std::generic_category().message(error_number); }

enum class Pipes { allowed, refused };

/// Whether a path names what is open already: standard input, or a pipe of the shell, <(...). Its
/// writer is there. Whoever opens another pipe would wait for one.
bool names_open_stream(const fs::path& file) {
  const std::string& name = file.native();
  return name == "/dev/stdin" || name.starts_with("/dev/fd/") || name.starts_with("/proc/self/fd/");
}

/// @throws FileError unless it is a file, or an open stream where those are allowed
void require_file(const fs::path& file, const fs::file_status& status, Pipes pipes) {
  const auto fail = [&](const std::string& why) { throw FileError(file.string() + ": " + why); };
  if (status.type() == fs::file_type::not_found) fail("there is no such file");
  if (fs::is_directory(status)) fail("is a folder, but must be a file");
  if (fs::is_character_file(status) || fs::is_block_file(status))
    fail("is a device, but must be a file");
  const bool is_stream = pipes == Pipes::allowed && names_open_stream(file);
  if (!is_stream && (fs::is_fifo(status) || fs::is_socket(status)))
    fail("is a pipe, but must be a file");
}

/// @param limit  what `most` is, as messages call it.
std::string read_bytes(const fs::path& file, std::size_t most, const std::string& limit,
                       Pipes pipes) {
  note_file(file);
  const auto fail = [&](const std::string& why) { throw FileError(file.string() + ": " + why); };
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  require_file(file, status, pipes);
  struct Close {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };
  const std::unique_ptr<std::FILE, Close> stream(std::fopen(file.c_str(), "rb"));
  if (!stream) fail("cannot be read: " + reason(errno));
  const std::uintmax_t size = fs::is_regular_file(status) ? fs::file_size(file, error) : 0;
  const auto refuse_size = [&] { fail("is larger than " + limit); };
  if (size > most) refuse_size();
  std::string bytes(static_cast<std::size_t>(size) + 1, '\0');
  std::size_t filled = 0;
  while (const std::size_t got =
             std::fread(bytes.data() + filled, 1, bytes.size() - filled, stream.get())) {
    filled += got;
    if (filled > most) refuse_size();
    if (filled == bytes.size())  // a pipe, or a file that grows
      bytes.resize(std::min(filled, most - filled) + filled + 1);
  }
  if (std::ferror(stream.get()) != 0) fail("cannot be read to its end");
  bytes.resize(filled);
  return bytes;
}

}  // namespace

std::string read_file_bytes(const fs::path& file, MemoryBudget& budget) {
  std::string bytes = read_bytes(
      file, budget.left,
      memory_size_text(budget.left) + ", what is left of the memory budget (--memory-budget)",
      Pipes::refused);
  budget.left -= bytes.size();
  return bytes;
}

std::string read_file_bytes(const fs::path& file) {
  MemoryBudget budget;
  return read_file_bytes(file, budget);
}

void require_regular_file(const fs::path& file) {
  std::error_code ignored;
  require_file(file, fs::status(file, ignored), Pipes::refused);
}

std::string read_stream_bytes(const fs::path& file, std::size_t most) {
  return read_bytes(file, most, memory_size_text(most), Pipes::allowed);
}

}  // namespace lamina
