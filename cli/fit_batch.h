// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "fit_page.h"
#include "lamina/base/core/shard.h"

namespace lamina::cli {

/// Measurements that a batch fits, and where its table goes.
struct FitBatch {
  std::string measurement;            ///< file
  std::vector<std::string> settings;  ///< of it
  std::string samples;                ///< a folder of CSV files, each in place of that of the first
                                      ///< entry, or one of a column for each sample
  std::string output;                 ///< CSV; may be empty
  std::string report;                 ///< HTML; may be empty
  FitMaking making;                   ///< of the report
  std::optional<Shard> shard = {};    ///< does that part alone, for `lamina merge`
};

/// Fits all files, goes on past those that cannot be, and lists these at the end.
/// A shard has what was refused in its file, and is none of these failures.
/// @throws InvalidInput if there is no CSV file or column; std::runtime_error if some were not
///         fitted, after the results are written.
void run_fit_batch(const FitBatch& batch, const CommonOptions& common);

/// Says how many samples there are. @throws InvalidInput if the first is refused
void check_fit_batch(const FitBatch& batch, const CommonOptions& common);

}  // namespace lamina::cli
