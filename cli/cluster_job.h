// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cluster_files.h"

// A command of lamina that many machines share: its shards, the job of each, and the merge.
namespace lamina::cli {

/// Kinds of files that shards leave, and the merge takes.
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

}  // namespace lamina::cli
