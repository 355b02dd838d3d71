// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cluster_files.h"

namespace lamina::cli {

/// Where a part of a job is: one of its shards, its preparation or its merge.
struct PartState {
  enum class Is {
    not_started,
    waiting,  ///< in Slurm's queue
    running,
    done,
    failed,  ///< ended with an exit code
    killed,  ///< ended without one
  };
  Is is = Is::not_started;
  int exit_code = 0;      ///< if it failed
  double seconds = 0.0;   ///< that it took, or has run; 0 if that is not known
  std::string host = {};  ///< where it was started
};

/// Progress of a job as seen now: its files, and Slurm's queue where there is one.
struct ClusterState {
  PartState prepare, merge;
  std::vector<PartState> shards;
  std::vector<std::string> slurm_jobs;  ///< that have shards waiting or running
  std::vector<std::string> warnings;    ///< of notes that are no part of the job

  [[nodiscard]] std::vector<int> shards_that_are(std::initializer_list<PartState::Is> states) const;
  /// By the mean time of shards that are done; absent without one.
  [[nodiscard]] std::optional<double> seconds_left() const;
};

/// Lines "JOB TASK STATE" of the user's jobs, as squeue lists them; absent where there is no Slurm.
using SlurmQueue = std::function<std::optional<std::string>()>;
[[nodiscard]] std::optional<std::string> slurm_queue();

/// Whatever bytes the notes in the job's folder hold.
/// @throws FileError if `submitted` cannot be read
[[nodiscard]] ClusterState find_cluster_state(const ClusterJob& job, const ClusterFiles& files,
                                              const SlurmQueue& slurm = slurm_queue);

}  // namespace lamina::cli
