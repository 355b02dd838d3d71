// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "cluster_job.h"

// Scripts for POSIX shells, which schedulers and people run.
namespace lamina::cli {

/// Makes one shard, unless it is there: by its number as an argument, or that of a scheduler's
/// array.
[[nodiscard]] std::string shard_script(const ClusterJob& job, const ClusterPlan& plan,
                                       const ClusterFiles& files);

/// Makes what shards share, once.
[[nodiscard]] std::string prepare_script(const ClusterJob& job, const ClusterPlan& plan,
                                         const ClusterFiles& files);

/// Adds up all shards.
[[nodiscard]] std::string merge_script(const ClusterJob& job, const ClusterPlan& plan,
                                       const ClusterFiles& files);

/// Hands shards to Slurm as job arrays, with the preparation before them and the merge behind them.
///
/// @param shards  in ascending order; none: only the merge is left
/// @param after   jobs of Slurm that the merge waits for, too
[[nodiscard]] std::string submit_script(const ClusterJob& job, const ClusterPlan& plan,
                                        const ClusterFiles& files, std::span<const int> shards,
                                        std::span<const std::string> after);

/// The highest index of an array is below this in Slurm unless a cluster's administrators say
/// otherwise; more shards are several arrays.
inline constexpr int slurm_array_size = 1000;

}  // namespace lamina::cli
