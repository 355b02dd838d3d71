// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/reading_warnings.h"

#include <mutex>
#include <set>
#include <utility>

namespace lamina {
namespace {

struct ReadingWarnings {
  std::mutex mutex;
  std::function<void(const std::string&)> told;
  std::set<std::string> texts;  ///< that were told
};

ReadingWarnings& reading_warnings() {
  static ReadingWarnings warnings;
  return warnings;
}

}  // namespace

void tell_reading_warnings(std::function<void(const std::string&)> told) {
  ReadingWarnings& warnings = reading_warnings();
  const std::scoped_lock lock(warnings.mutex);
  warnings.told = std::move(told);
  warnings.texts.clear();
}

void warn_of_file(const std::string& text) {
  ReadingWarnings& warnings = reading_warnings();
  std::function<void(const std::string&)> told;
  {
    const std::scoped_lock lock(warnings.mutex);
    if (!warnings.told || !warnings.texts.insert(text).second) return;
    told = warnings.told;
  }
  told(text);  // which may throw
}

}  // namespace lamina
