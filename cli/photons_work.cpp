// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "lamina/base/core/error.h"
#include "photons_options.h"

namespace lamina::cli {

namespace fs = std::filesystem;

PhotonWork::PhotonWork(const PhotonsOptions& options) : options_(options) {
  if (options.checkpoint.empty() || is_device(options.checkpoint) ||
      !fs::exists(options.checkpoint))
    return;
  if (!options.resumes)
    throw InvalidInput(
        fmt::format("--checkpoint: {} keeps what an earlier run has counted; --resume goes on from "
                    "it, else remove it",
                    options.checkpoint));
  runs_ = load_photon_runs(options.checkpoint, options.common.memory);
}

void PhotonWork::count(const Place& place, const LayerStack& stack, MonteCarloOptions photons) {
  const auto refuse = [&](const std::string& what) {
    throw InvalidInput(
        fmt::format("{}: {}; remove it, or leave out --resume", options_.checkpoint, what));
  };
  if (place.run == runs_.size())
    runs_.push_back({.name = place.name,
                     .bands = {},
                     .counts = {},
                     .shards = {photons.shard.index},
                     .of = photons.shard.count});
  PhotonRun& run = runs_[place.run];
  const bool is_kept = place.band < run.counts.size();
  if (run.name != place.name || run.shards != std::set{photons.shard.index} ||
      run.of != photons.shard.count || (is_kept && run.bands[place.band] != place.band_name))
    refuse(fmt::format("must be of {}, shard {}, but is of {}", place.name, options_.shard,
                       title_of(run)));
  if (!is_kept) {
    run.bands.push_back(place.band_name);
    run.counts.emplace_back();
  }
  PhotonCounts& counts = run.counts[place.band];
  const bool keeps = !options_.checkpoint.empty();
  if (keeps)
    photons.keep = [&](const PhotonCounts& so_far) {
      counts = so_far;
      save_photon_runs(runs_, options_.checkpoint);
    };
  if (!is_kept) {
    counts = count_photons(stack, photons);
  } else {
    try {
      counts = continue_photons(stack, photons, counts);
    } catch (const InvalidInput& error) {
      refuse(error.what());
    }
  }
  if (keeps) save_photon_runs(runs_, options_.checkpoint);
}

void PhotonWork::finish() const {
  if (options_.checkpoint.empty()) return;
  const bool is_whole = !was_interrupted() && std::ranges::none_of(runs_, [](const PhotonRun& run) {
    return std::ranges::any_of(run.counts, &PhotonCounts::was_stopped);
  });
  if (is_whole)
    fs::remove(options_.checkpoint);
  else
    say(fmt::format("stopped early; the same command with --resume goes on from {}",
                    options_.checkpoint));
}

}  // namespace lamina::cli
