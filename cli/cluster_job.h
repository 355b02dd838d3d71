// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lamina/core/memory_budget.h"

// A command of lamina that many machines share: its shards, the job of each, and the merge.
namespace lamina::cli {

/// What a scheduler is asked for.
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

/// What a shard leaves, and the merge takes.
enum class ShardKind {
  picture,  ///< sums of a film, for `lamina merge`
  photons,  ///< JSON of counts, of a run that can go on
  fits,     ///< JSON of the samples of a batch
  kept      ///< what the command itself keeps in a folder, for the same command without --shard
};

/// How the job's command is split and what comes of it.
struct ClusterPlan {
  std::vector<std::string> prepare;  ///< makes what shards share; empty: nothing is to be made
  bool finds_method = false;         ///< of light below surfaces: it is left open until prepared
  std::vector<std::string> shard;    ///< without --shard, output and threads
  std::vector<std::string> merge;    ///< without the shards
  ShardKind kind = ShardKind::picture;
  std::filesystem::path result;  ///< the first file of it, which gives the job its name
};

/// Looks at the command as it does itself with --check.
/// @param job_folder  of its scripts; empty: beside the result
/// @throws InvalidInput naming what is wrong with it
[[nodiscard]] ClusterPlan make_cluster_plan(const ClusterJob& job,
                                            const std::filesystem::path& job_folder = {});

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
