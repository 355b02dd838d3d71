// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "monte_carlo_method.h"
#include "photons_report.h"
#include "shard_option.h"

namespace lamina::cli {

/// Options of `lamina photons`.
struct PhotonsOptions {
  CommonOptions common;
  std::string material, bands;
  std::vector<std::string> settings;  ///< of --set
  MonteCarloEffort effort;
  std::string shard = "0/1";
  std::string incidence = "normal";
  Beam::Shape beam = Beam::Shape::pencil;
  double beam_radius = 0.0;
  std::vector<std::string> tallies;
  int r_bins = 100, z_bins = 100, angles = 30, cosines = 10, azimuths = 18, path_bins = 100,
      time_bins = 100;
  double dr = 0.05, dz = 0.02, dl = 1.0;
  double dt = 20.0;                 ///< [ps]
  std::vector<double> frequencies;  ///< [MHz]
  std::vector<double> log_r = {1e-3, 1e2};
  int log_bins = 100;
  std::vector<double> detectors;
  double detector_width = 0.1;
  std::vector<double> directions;
  std::uint32_t max_events = MonteCarloOptions{}.max_events;
  std::string output = ".";
  std::string plot;
  std::string checkpoint;
  bool resumes = false;
  bool with_counts = false;
  bool only_checks = false;
};

/// Whether the result has the raw sums.
[[nodiscard]] inline bool writes_counts(const PhotonsOptions& options) {
  return options.with_counts || read_shard(options.shard).count > 1;
}

/// Sums that a run of these tallies has.
[[nodiscard]] std::size_t cells_of(const PhotonTallies& tallies, std::size_t layers);

/// Before the work: that a file of that many cells, if one is written, can be read again.
/// @throws InvalidInput
void require_readable(const PhotonsOptions& options, std::size_t cells);

/// Photons that are counted run by run and band by band, and kept in a file where --checkpoint
/// says.
class PhotonWork {
 public:
  /// Reads what an earlier call has kept, where --resume says. @throws InvalidInput; FileError
  explicit PhotonWork(const PhotonsOptions& options);

  /// Place where photons are counted, by its number and its name. Numbers come in their order.
  struct Place {
    std::size_t run = 0;
    std::string name;
    std::size_t band = 0;
    std::string band_name;
  };

  /// Counts photons, or goes on where an earlier call stopped.
  /// @throws InvalidInput if what was kept is of another run.
  void count(const Place& place, const LayerStack& stack, MonteCarloOptions photons);

  [[nodiscard]] const std::vector<PhotonRun>& runs() const { return runs_; }

  /// Removes the file, or says where it is if photons are left to be counted.
  void finish() const;

 private:
  const PhotonsOptions& options_;
  std::vector<PhotonRun> runs_;
};

/// The runs of an MCML file, each with its output file.
void trace_mcml(const PhotonsOptions& options, PhotonWork& work);

}  // namespace lamina::cli
