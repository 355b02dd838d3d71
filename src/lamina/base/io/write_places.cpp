// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/write_places.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

/// The place with all links followed, those to nothing too, which writing would follow.
fs::path real_place(fs::path place) {
  std::error_code error;
  for (int links = 0; links < 40 && fs::is_symlink(place, error); ++links)
    place = place.parent_path() / fs::read_symlink(place, error);
  place = fs::absolute(place, error);
  const fs::path real = fs::weakly_canonical(place, error);
  return error ? place.lexically_normal() : real;  // writing there will fail, too
}

std::vector<fs::path>& allowed() {
  static std::vector<fs::path> folders;
  return folders;
}

}  // namespace

bool is_inside(const fs::path& place, const fs::path& folder) {
  const fs::path relative = real_place(place).lexically_relative(real_place(folder));
  return !relative.empty() && *relative.begin() != "..";
}

void write_only_inside(std::vector<fs::path> folders) { allowed() = std::move(folders); }

void require_write_place(const fs::path& place) {
  if (allowed().empty() || std::ranges::any_of(allowed(), [&](const fs::path& folder) {
        return is_inside(place, folder);
      }))
    return;
  throw WriteError(place.string() + ": must be inside of " + allowed().front().string() +
                   ", the only folder to write to");
}

void make_folder(const fs::path& folder) {
  require_write_place(folder);
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error && !fs::is_directory(folder, error))
    error = std::make_error_code(std::errc::not_a_directory);
  if (error) throw WriteError(folder.string() + ": the folder cannot be made: " + error.message());
}

}  // namespace lamina
