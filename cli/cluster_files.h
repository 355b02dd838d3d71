// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/io/json_input.h"

// A job of a cluster as files: what it is, and its folder.
namespace lamina::cli {

/// Resources asked of a scheduler.
struct ClusterJob {
  std::vector<std::string> command;  ///< makes the whole, behind "lamina"
  int shards = 0;                    ///< >= 1
  std::string folder;                ///< the command's working folder, absolute
  std::string partition, time;       ///< as Slurm takes them; "": its default
  std::string memory;                ///< of a shard, as Slurm takes it: 4G
  int cores = 1;                     ///< of a shard
  std::vector<std::string> sbatch;   ///< more options of sbatch, a word each
  friend bool operator==(const ClusterJob&, const ClusterJob&) = default;
};

inline constexpr int most_shards = 1'000'000;

/// @throws InvalidInput naming line and field; FileError
[[nodiscard]] ClusterJob load_cluster_job(const std::filesystem::path& file, MemoryBudget memory);
void save_cluster_job(const ClusterJob& job, const std::filesystem::path& file);

/// The words of a command: a line, as a shell parts it, or an array of words.
/// @throws InvalidInput naming line and field
[[nodiscard]] std::vector<std::string> read_words(const JsonInput& input);

/// Files of a job, in its folder.
struct ClusterFiles {
  explicit ClusterFiles(const std::filesystem::path& folder);

  std::filesystem::path folder;  ///< absolute
  [[nodiscard]] std::filesystem::path job() const { return folder / "job.json"; }
  [[nodiscard]] std::filesystem::path prepared() const { return folder / "prepared.json"; }
  [[nodiscard]] std::filesystem::path shards() const { return folder / "shards"; }
  [[nodiscard]] std::filesystem::path shard(int index) const;
  /// When a part was started and ended, as its script writes it: of a shard, or "merge", "prepare".
  [[nodiscard]] std::filesystem::path state(const std::string& part) const;
  [[nodiscard]] std::filesystem::path log(const std::string& part) const;
  [[nodiscard]] std::filesystem::path script(const std::string& name) const;
  [[nodiscard]] std::filesystem::path submitted() const { return folder / "submitted"; }
};

}  // namespace lamina::cli
