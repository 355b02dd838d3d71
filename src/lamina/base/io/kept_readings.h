// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lamina/base/io/files_read.h"

namespace lamina {

/// Results of reading files, for who reads the same ones again and again: a result is taken anew
/// where a file that it was made of is not as it was.
///
/// While a Use lives, kept_reading of its thread looks here. One Use at a time; results that no Use
/// has asked for since the one before are forgotten.
class KeptReadings {
 public:
  class Use {
   public:
    explicit Use(KeptReadings& readings);
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    KeptReadings& readings_;
    KeptReadings* outer_;
  };

  [[nodiscard]] std::size_t count() const { return readings_.size(); }

 private:
  friend std::shared_ptr<const void> kept_reading_of(
      const std::string& key, const std::function<std::shared_ptr<const void>()>& read);
  struct Reading {
    std::vector<FileState> files;
    std::shared_ptr<const void> result;
    std::uint64_t used = 0;  ///< by which Use
  };
  std::map<std::string, Reading> readings_;
  std::uint64_t uses_ = 0;
};

/// Whether this thread keeps what it reads.
[[nodiscard]] bool are_readings_kept();

/// kept_reading of any type.
[[nodiscard]] std::shared_ptr<const void> kept_reading_of(
    const std::string& key, const std::function<std::shared_ptr<const void>()>& read);

/// Result of `read()`, or what it was before where this thread keeps readings and no file that was
/// read for it has changed. FilesRead is told of its files either way.
/// @param key  of all that it follows from but the content of files, its type too
template <class Result, class Read>
[[nodiscard]] Result kept_reading(const std::string& key, const Read& read) {
  if (!are_readings_kept()) return read();
  const std::shared_ptr<const void> found =
      kept_reading_of(key, [&] { return std::make_shared<const Result>(read()); });
  return *std::static_pointer_cast<const Result>(found);
}

}  // namespace lamina
