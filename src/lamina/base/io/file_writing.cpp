// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/file_parts.h"
#include "lamina/base/io/folder_names.h"
#include "lamina/base/io/write_places.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

// A file in the making: hidden, with a name that nobody can foresee. It is locked as long as its
// process lives, so that one without a lock is left over from a process that ended too early.
constexpr std::string_view before_name = ".lamina-", after_name = ".tmp";

/// A step of the operating system failed with this error number.
[[noreturn]] void fail(int number = errno) {
  throw std::system_error(number != 0 ? number : EIO, std::generic_category());
}

void check(int result) {
  if (result != 0) fail();
}

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] bool is_open() const { return number_ >= 0; }

  void write(std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = ::write(number_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) fail();
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  }

  /// Waits until the bytes, or the names in a folder, would outlast a loss of power. Some file
  /// systems cannot say.
  void synchronize() const {
    if (fsync(number_) != 0 && errno != EINVAL && errno != ENOTSUP) fail();
  }

  void close() { check(::close(std::exchange(number_, -1))); }  // errors may show up here only

 private:
  int number_;
};

/// A file in the making beside `target`, removed unless it took its place.
class Beside {
 public:
  explicit Beside(const fs::path& folder) : file_(create(folder)) {}
  ~Beside() {
    if (!name_.empty()) unlink(name_.c_str());
  }
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;

  [[nodiscard]] Descriptor& file() { return file_; }

  void take_place_of(const fs::path& target) {
    check(rename(name_.c_str(), target.c_str()));
    name_.clear();
  }

 private:
  int create(const fs::path& folder) {
    std::random_device random;
    for (int tries = 0; tries < 100; ++tries) {
      fs::path name = folder / before_name;
      for (int i = 0; i < 16; ++i) name += "0123456789abcdef"[random() % 16];
      name += after_name;
      const int number =
          open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
      if (number < 0 && errno == EEXIST) continue;
      if (number < 0) fail();
      // Between opening and locking, another process may have taken it for left over.
      struct stat status {};
      const bool is_locked = flock(number, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
      if (is_locked && fstat(number, &status) == 0 && status.st_nlink > 0) {
        name_ = name;
        return number;
      }
      ::close(number);
    }
    fail(EEXIST);
  }

  fs::path name_;
  Descriptor file_;
};

/// Removes the user's files in the making whose process is gone.
void sweep(const fs::path& folder) {
  std::error_code error;
  for (const std::string& name : folder_names(folder, error)) {
    if (!name.starts_with(before_name) || !name.ends_with(after_name)) continue;
    const fs::path left_over = folder / name;
    const Descriptor file(open(left_over.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    struct stat status {};
    if (file.is_open() && fstat(file.number(), &status) == 0 && S_ISREG(status.st_mode) &&
        status.st_uid == geteuid() && flock(file.number(), LOCK_EX | LOCK_NB) == 0)
      unlink(left_over.c_str());
  }
}

/// Whether this is a link that the user or the system has made. Those of others, in a folder that
/// all may write to, could lead to any of the user's files: they are replaced.
bool is_to_be_followed(const fs::path& file) {
  struct stat status {};
  return lstat(file.c_str(), &status) == 0 && S_ISLNK(status.st_mode) &&
         (status.st_uid == geteuid() || status.st_uid == 0);
}

/// Such as /dev/stdout: no renaming.
void write_into(const fs::path& device, const WriteParts& write_parts) {
  Descriptor file(open(device.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC));
  if (!file.is_open()) fail();
  write_parts([&](std::span<const std::byte> part) { file.write(part); });
  file.close();
}

void replace(const fs::path& target, const WriteParts& write_parts, Lasting lasting) {
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  sweep(folder);
  Beside beside(folder);
  write_parts([&](std::span<const std::byte> part) { beside.file().write(part); });
  struct stat before {};
  if (stat(target.c_str(), &before) == 0) fchmod(beside.file().number(), before.st_mode & 0777);
  if (lasting == Lasting::power_loss) beside.file().synchronize();
  beside.take_place_of(target);
  beside.file().close();
  if (lasting == Lasting::process) return;
  const Descriptor names(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (names.is_open()) names.synchronize();  // a folder may be writable, but not readable
}

}  // namespace

void write_file_parts(const fs::path& file, const WriteParts& write_parts, Lasting lasting) {
  require_write_place(file);
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  try {
    if (fs::is_directory(status)) fail(EISDIR);
    if (fs::exists(status) && !fs::is_regular_file(status)) return write_into(file, write_parts);
    fs::path target = file;
    for (int links = 0; links < 40 && is_to_be_followed(target); ++links)
      target = target.parent_path() / fs::read_symlink(target, error);
    replace(target, write_parts, lasting);
  } catch (const std::system_error& failure) {
    throw WriteError(file.string() + ": cannot be written: " + failure.code().message());
  }
}

void write_file_bytes(const fs::path& file, std::span<const std::byte> bytes, Lasting lasting) {
  write_file_parts(
      file, [&](const WritePart& write) { write(bytes); }, lasting);
}

}  // namespace lamina
