// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "console.h"
#include "lamina/core/memory_budget.h"
#include "lamina/scattering/photon_tallies.h"

namespace lamina::cli {

/// Photons counted through one material: what `photons` computes, what shards keep in files and
/// `merge` adds up.
struct PhotonRun {
  std::string name;                  ///< of the material, or MCML's output file
  std::vector<std::string> bands;    ///< "R", "G", "B" or nm; one, unnamed, for MCML's files
  std::vector<PhotonCounts> counts;  ///< [band]
  int shard = 0, shards = 1;         ///< shards > 1 only while not all are merged
};

/// Totals and tallies as JSON; the last index of every array is the band.
/// @param with_counts  adds the raw sums, from which `merge` goes on.
[[nodiscard]] nlohmann::ordered_json photon_json(const PhotonRun& run, bool with_counts);

/// Totals as a table for people.
[[nodiscard]] std::string photon_text(const PhotonRun& run);

/// Prints runs, writes them as JSON and as a plot where asked.
/// @param command  the subcommand that made them.
void print_photon_runs(const std::vector<PhotonRun>& runs, const std::string& command,
                       const CommonOptions& options, bool with_counts, const std::string& plot);

/// Plots of R(r) and of R(angle), as far as they were tallied.
void plot_photons(const PhotonRun& run, const std::string& file);

/// The runs of a file that `photons --json` wrote with its raw sums.
/// @throws InvalidInput naming file, line and field; FileError.
[[nodiscard]] std::vector<PhotonRun> load_photon_runs(const std::filesystem::path& file,
                                                      MemoryBudget memory);

/// Raw sums as JSON.
[[nodiscard]] nlohmann::ordered_json counts_json(const PhotonCounts& counts);

}  // namespace lamina::cli
