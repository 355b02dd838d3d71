// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/core/shard.h"
#include "lamina/base/io/json_output.h"
#include "merge_options.h"

namespace lamina::cli {

/// A sample that was fitted, as the table of a batch has it.
struct FittedSample {
  struct Number {
    std::string name;
    double value = 0.0;
    std::optional<double> error;  ///< absent where it is not known
  };
  std::string name;
  double chi_squared = 0.0;
  std::int64_t degrees_of_freedom = 0;
  bool has_converged = false;
  std::vector<Number> numbers;
};

/// Results of the fits of a batch.
struct FittedBatch {
  struct Refused {
    std::string name, reason;
  };
  std::vector<FittedSample> samples;
  std::vector<Refused> refused;
  std::vector<JsonOutput> fits;  ///< of each sample, all that was found
};

/// Says what was refused, writes the table and the JSON, and prints a line for each sample.
/// @param command  which made it
/// @param table    CSV; may be empty
/// @throws         std::runtime_error behind that if samples were refused
void report_batch(const FittedBatch& batch, const std::string& command, const std::string& table,
                  const CommonOptions& common);

/// A part of a batch that other machines share.
struct FitShard {
  Shard shard;
  std::string version;               ///< of lamina
  std::uint64_t key = 0;             ///< of all files that the batch reads, names and options
  std::vector<std::string> command;  ///< makes a shard once --shard and --json are added
  FittedBatch batch;
};

/// Encodes a shard as JSON, with a checksum of all that counts.
[[nodiscard]] JsonOutput fit_shard_json(const FitShard& shard);

/// Whether a file starts as JSON of such a shard does.
[[nodiscard]] bool is_fit_shard(const std::string& file, MemoryBudget memory);

/// Puts shards of batches together: --output is the table, --json all fits.
/// @throws InvalidInput naming a shard that does not belong to the first, or is there twice;
///         FileError if one is damaged, or if all are needed and some are missing
void merge_fits(const MergeOptions& options);

}  // namespace lamina::cli
