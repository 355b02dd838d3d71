// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/files_read.h"

#include <sys/stat.h>

namespace lamina {
namespace {

thread_local FilesRead* told = nullptr;

}  // namespace

FileState state_of(const std::filesystem::path& file) {
  struct stat found {};
  if (stat(file.c_str(), &found) != 0) return {.file = file};
  return {.file = file,
          .is_there = true,
          .size = static_cast<std::uintmax_t>(found.st_size),
          .node = static_cast<std::uintmax_t>(found.st_ino),
          .changed_nanoseconds =
              std::int64_t{1'000'000'000} * found.st_mtim.tv_sec + found.st_mtim.tv_nsec};
}

FilesRead::FilesRead() : outer_(told) { told = this; }

FilesRead::~FilesRead() {
  told = outer_;
  if (outer_) outer_->files_.merge(files_);
}

std::vector<FileState> FilesRead::files() const {
  std::vector<FileState> files;
  files.reserve(files_.size());
  for (const auto& [file, state] : files_) files.push_back(state);
  return files;
}

void note_file(const std::filesystem::path& file) {
  if (told && !told->files_.contains(file)) told->files_.emplace(file, state_of(file));
}

}  // namespace lamina
