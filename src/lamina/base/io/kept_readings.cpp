// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/kept_readings.h"

#include <algorithm>

namespace lamina {
namespace {

thread_local KeptReadings* kept_by_thread = nullptr;

}  // namespace

KeptReadings::Use::Use(KeptReadings& readings) : readings_(readings), outer_(kept_by_thread) {
  kept_by_thread = &readings;
  ++readings.uses_;
}

KeptReadings::Use::~Use() {
  kept_by_thread = outer_;
  std::erase_if(readings_.readings_,
                [&](const auto& entry) { return entry.second.used + 1 < readings_.uses_; });
}

bool are_readings_kept() { return kept_by_thread != nullptr; }

std::shared_ptr<const void> kept_reading_of(
    const std::string& key, const std::function<std::shared_ptr<const void>()>& read) {
  KeptReadings& kept = *kept_by_thread;
  auto found = kept.readings_.find(key);
  const auto is_as_it_was = [](const FileState& state) { return state_of(state.file) == state; };
  if (found == kept.readings_.end() || !std::ranges::all_of(found->second.files, is_as_it_was)) {
    KeptReadings::Reading reading;
    {
      const FilesRead files;
      reading.result = read();
      reading.files = files.files();
    }
    found = kept.readings_.insert_or_assign(key, std::move(reading)).first;
  }
  found->second.used = kept.uses_;
  for (const FileState& state : found->second.files) note_file(state.file);
  return found->second.result;
}

}  // namespace lamina
