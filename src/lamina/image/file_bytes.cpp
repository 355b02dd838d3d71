// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/image/file_bytes.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include "lamina/core/error.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

std::string reason(int error_number) { return std::generic_category().message(error_number); }

/// Writes straight into `place`. Returns the error number, 0 for none.
int write_into(const fs::path& place, std::span<const std::byte> bytes) {
  errno = 0;
  std::ofstream stream(place, std::ios::binary | std::ios::trunc);
  if (stream)
    stream.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
  if (stream) stream.close();
  if (stream) return 0;
  return errno != 0 ? errno : EIO;
}

}  // namespace

std::vector<std::byte> read_file_bytes(const fs::path& file) {
  const auto fail = [&](const std::string& why) { throw FileError(file.string() + ": " + why); };
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status))
    fail(error && error.value() != ENOENT ? error.message() : "does not exist");
  if (fs::is_directory(status)) fail("must be a file, but is a folder");
  if (!fs::is_regular_file(status)) fail("must be a file, but is a device, pipe or socket");
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) fail("cannot be read: " + error.message());
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail("cannot be read: " + reason(errno));
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (stream.gcount() != static_cast<std::streamsize>(bytes.size())) fail("cannot be read whole");
  return bytes;
}

void write_file_bytes(const fs::path& file, std::span<const std::byte> bytes) {
  const auto fail = [&](const std::string& why) {
    throw WriteError(file.string() + ": cannot be written: " + why);
  };
  std::error_code error;
  fs::path target = file;
  for (int links = 0; links < 40 && fs::is_symlink(fs::symlink_status(target, error)); ++links)
    target = target.parent_path() / fs::read_symlink(target, error);
  const fs::file_status status = fs::status(target, error);
  if (fs::is_directory(status)) fail("it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status)) {  // such as /dev/stdout: no renaming
    if (const int number = write_into(target, bytes)) fail(reason(number));
    return;
  }
  fs::path beside = target;
  beside += "." + std::to_string(getpid()) + ".tmp";
  const int number = write_into(beside, bytes);
  error.clear();
  if (number == 0) fs::rename(beside, target, error);
  if (number == 0 && !error) return;
  std::error_code ignored;
  fs::remove(beside, ignored);
  fail(number != 0 ? reason(number) : error.message());
}

}  // namespace lamina
