// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/file_parts.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& why) {
  throw FileError(file.string() + ": " + why);
}

std::string reason() { return std::generic_category().message(errno); }

}  // namespace

FileParts::FileParts(std::filesystem::path file) : file_(std::move(file)) {
  descriptor_ =
      open(file_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe would be waited for
  if (descriptor_ < 0)
    fail(file_, errno == ENOENT ? "there is no such file" : "cannot be read: " + reason());
  struct stat status {};
  const bool is_file = fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode);
  if (is_file) {
    size_ = static_cast<std::uint64_t>(status.st_size);
    return;
  }
  close(descriptor_);
  fail(file_, "must be a regular file");
}

FileParts::~FileParts() { close(descriptor_); }

void FileParts::read(std::uint64_t at, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t got = pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(file_, "cannot be read: " + reason());
    if (got == 0) fail(file_, "ends too early");
    at += static_cast<std::uint64_t>(got);
    bytes = bytes.subspan(static_cast<std::size_t>(got));
  }
}

}  // namespace lamina
