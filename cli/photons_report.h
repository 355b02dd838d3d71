// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "console.h"
#include "lamina/base/core/memory_budget.h"
#include "lamina/base/io/json_output.h"
#include "lamina/solve/scattering/monte_carlo/photon_tallies.h"

namespace lamina::cli {

/// Photons counted through one material: what `photons` computes, what shards keep in files and
/// `merge` adds up.
struct PhotonRun {
  std::string name;                  ///< of the material, or MCML's output file
  std::vector<std::string> bands;    ///< "R", "G", "B" or nm; one, unnamed, for MCML's files
  std::vector<PhotonCounts> counts;  ///< [band]
  std::set<int> shards = {0};        ///< that were counted,
  int of = 1;                        ///< of so many; > 1 only while not all are merged
};

/// Name of a run, and the shards that it has if those are not all.
[[nodiscard]] std::string title_of(const PhotonRun& run);

/// Totals and tallies as JSON; the last index of every array is the band.
[[nodiscard]] JsonOutput photon_json(const PhotonRun& run);

/// Totals as a table for people.
[[nodiscard]] std::string photon_text(const PhotonRun& run);

/// Prints runs, writes them as JSON and as a plot where asked.
/// @param command      the subcommand that made them.
/// @param with_counts  adds the raw sums to the JSON, from which `merge` goes on.
void print_photon_runs(const std::vector<PhotonRun>& runs, const std::string& command,
                       const CommonOptions& options, bool with_counts, const std::string& plot);

/// Plots of R(r) and of R(angle), as far as they were tallied.
void plot_photons(const PhotonRun& run, const std::string& file);

/// The raw sums of runs as JSON, with a checksum of each run.
[[nodiscard]] JsonOutput counts_json(const std::vector<PhotonRun>& runs);

/// A file of raw sums alone. @throws WriteError
void save_photon_runs(const std::vector<PhotonRun>& runs, const std::string& file);

/// The runs of a file that has raw sums: of save_photon_runs, or the JSON of a result.
/// @throws InvalidInput naming file, line and field, also if the sums are not as they were written;
/// FileError.
[[nodiscard]] std::vector<PhotonRun> load_photon_runs(const std::filesystem::path& file,
                                                      MemoryBudget memory);

}  // namespace lamina::cli
