// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "watched_files.h"

#include <algorithm>
#include <thread>

namespace lamina::cli {
namespace {

using namespace std::chrono_literals;
constexpr auto between_looks = 200ms;
constexpr auto until_at_rest = 100ms;

std::vector<FileState> states_now(const std::vector<FileState>& files) {
  std::vector<FileState> now;
  now.reserve(files.size());
  for (const FileState& file : files) now.push_back(state_of(file.file));
  return now;
}

}  // namespace

bool WatchedFiles::has_changed() {
  if (has_changed_) return true;
  if (Clock::now() < next_.load()) return false;
  const std::unique_lock alone(asks_, std::try_to_lock);
  if (!alone) return false;
  if (!name_of_changed().empty()) has_changed_ = true;
  next_ = Clock::now() + between_looks;
  return has_changed_;
}

void WatchedFiles::wait_for_change() {
  while (!has_changed()) std::this_thread::sleep_for(between_looks);
  std::vector<FileState> before, now = states_now(files_);
  do {
    before = std::move(now);
    std::this_thread::sleep_for(until_at_rest);
    now = states_now(files_);
  } while (before != now);
}

std::string WatchedFiles::name_of_changed() const {
  const auto changed = std::ranges::find_if(
      files_, [](const FileState& file) { return state_of(file.file) != file; });
  return changed == files_.end() ? "" : changed->file.string();
}

int WatchedFiles::count() const {
  return static_cast<int>(std::ranges::count(files_, true, &FileState::is_there));
}

}  // namespace lamina::cli
