// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lamina/reproduction/item.h"

namespace lamina::cli {

/// The commands of an item that have finished, kept in its folder as finished.json, so that making
/// it can go on where it was interrupted.
class FinishedRuns {
 public:
  /// @param resumes  take what an earlier call has finished, if it had the same program, files and
  ///                 commands; else begin anew
  FinishedRuns(const ReproductionItem& item, const std::filesystem::path& folder,
               const std::filesystem::path& sources, bool resumes);

  /// The result of the next command if it has finished earlier.
  [[nodiscard]] std::optional<std::string> next();

  /// Keeps the result of the next command. @throws WriteError.
  void add(const std::string& result, double seconds);

  /// CPU time of the commands that are not run again [s].
  [[nodiscard]] double reused_seconds() const { return reused_seconds_; }

 private:
  struct Finished {
    std::string result;
    double seconds = 0.0;
  };
  std::filesystem::path file_;
  std::string made_by_;  ///< program, files and commands, as JSON
  std::vector<Finished> finished_;
  std::size_t next_ = 0;
  double reused_seconds_ = 0.0;
};

}  // namespace lamina::cli
