// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/solve/scattering/monte_carlo/internal/photon_scene.h"

namespace lamina {
namespace {

using photon::BatchSums;
using photon::Scene;
using photon::TallyPlan;

__extension__ typedef __int128 Wide;

WideSum wide(Wide value) {
  return {.low = static_cast<std::uint64_t>(value),
          .high = static_cast<std::uint64_t>(value >> 64)};
}

/// Photons per batch: the unit of parallel work and of the statistics of volume tallies. It depends
/// on the options alone, so that every shard and every number of threads cuts the same batches.
std::uint64_t batch_size(std::uint64_t photons) {
  return std::clamp<std::uint64_t>(photons / 64, 256, 1u << 16);
}

void add_batch(const BatchSums& sums, std::uint64_t photons, PhotonCounts& counts) {
  for (std::size_t i = 0; i < sums.cells.size(); ++i) {
    add(counts.first[i], wide(sums.cells[i].first));
    add(counts.second[i], wide(sums.cells[i].second));
  }
  for (std::size_t i = 0; i < sums.volume.size(); ++i) {
    add(counts.volume_first[i], wide(sums.volume[i]));
    const double part = std::ldexp(static_cast<double>(sums.volume[i]), -photon::volume_scale);
    const double square = part * part / static_cast<double>(photons);
    add(counts.volume_second[i],
        wide(static_cast<Wide>(std::ldexp(square, photon::volume_square_scale))));
  }
  counts.photons += photons;
  counts.batches += 1;
  counts.events += sums.events;
}

/// Whether the totals are known as well as asked.
bool is_precise(const PhotonCounts& counts, double relative_error) {
  const MonteCarloResult result = summarize(counts);
  const auto is_good = [&](const Estimate& e) {
    return e.value + 2.0 * e.standard_error < 1e-4 || e.standard_error <= relative_error * e.value;
  };
  return is_good(result.diffuse_reflectance) && is_good(result.transmittance);
}

/// All that decides the numbers, so that shards of different runs are not mixed.
std::string name_run(const LayerStack& stack, const MonteCarloOptions& options) {
  PlainTextStream name;
  name.precision(17);
  name << "squares per photon, photons " << options.photons << ", seed " << options.seed
       << ", incidence " << (options.incidence.is_diffuse ? -1.0 : options.incidence.theta)
       << ", beam " << static_cast<int>(options.beam.shape) << ' ' << options.beam.radius
       << ", max_events " << options.max_events << ", roulette_weight " << options.roulette_weight
       << ", ior " << stack.ior_above() << ' ' << stack.ior_below() << ", ground "
       << stack.ground().reflectance << ' ' << stack.ground().top.roughness;
  for (const Layer& layer : stack.layers())
    name << ", layer " << layer.medium.sigma_a << ' ' << layer.medium.sigma_s << ' '
         << layer.medium.g << ' ' << layer.medium.ior << ' ' << layer.thickness << ' '
         << layer.top.roughness << ' ' << static_cast<int>(layer.top.distribution) << ' '
         << legendre_moment(phase_function(layer), 2);
  if (options.clear_top_is_specular) name << ", clear top is specular";
  return name.str();
}

PhotonCounts make_counts(const LayerStack& stack, const MonteCarloOptions& options,
                         const Scene& scene, const TallyPlan& plan) {
  PhotonCounts counts;
  counts.tallies = options.tallies;
  counts.layers = stack.layers().size();
  counts.specular = scene.specular;
  counts.has_random_specular = scene.enters_at_random && scene.eta[0] != 1.0f;
  counts.length_unit = scene.length_unit;
  counts.run = name_run(stack, options);
  counts.first.resize(plan.layout.cells);
  counts.second.resize(plan.layout.cells);
  counts.volume_first.resize(plan.layout.volume_cells);
  counts.volume_second.resize(plan.layout.volume_cells);
  return counts;
}

/// A run taken apart: what it traces, and in which batches.
struct Run {
  Scene scene;
  TallyPlan plan;
  std::uint64_t batch_size = 0;
  std::uint64_t batches = 0;  ///< of this shard

  /// Number of the first photon of the shard's batch i.
  [[nodiscard]] std::uint64_t first_photon(std::uint64_t i, const Shard& shard) const {
    return (static_cast<std::uint64_t>(shard.index) + i * static_cast<std::uint64_t>(shard.count)) *
           batch_size;
  }
};

Run make_run(const LayerStack& stack, const MonteCarloOptions& options) {
  photon::check_tallies(options.tallies);
  Run run{.scene = photon::make_scene(stack, options)};
  run.plan = photon::make_tally_plan(options.tallies, stack.layers().size(), run.scene.length_unit);
  check_memory(run.plan.layout, static_cast<std::size_t>(thread_count()));
  run.batch_size = batch_size(options.photons);
  const std::uint64_t all = (options.photons + run.batch_size - 1) / run.batch_size;
  const auto shards = static_cast<std::uint64_t>(options.shard.count);
  const auto shard = static_cast<std::uint64_t>(options.shard.index);
  run.batches = all > shard ? (all - shard + shards - 1) / shards : 0;
  return run;
}

/// Whether a run is precise enough is asked between rounds only, which double, so that the answer
/// does not depend on the order in which batches finish.
std::uint64_t end_of_round(std::uint64_t batches) {
  std::uint64_t end = 16;
  while (end < batches) end *= 2;
  return end;
}

bool is_done(const Run& run, const MonteCarloOptions& options, const PhotonCounts& counts) {
  if (counts.batches >= run.batches) return true;
  return options.relative_error > 0.0 && counts.batches == end_of_round(counts.batches) &&
         is_precise(counts, options.relative_error);
}

/// Traces the batches from counts.batches on. All that are begun are finished, so that the counts
/// are always those of the first so many.
void trace_batches(const Run& run, const MonteCarloOptions& options, PhotonCounts& counts) {
  constexpr double keep_seconds = 30.0;
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  };
  const Clock::time_point start = Clock::now();
  Clock::time_point kept = start;
  std::mutex mutex;
  bool is_over = is_done(run, options, counts);
  for (std::atomic<bool> stopped = false; !is_over && !stopped;) {
    const std::uint64_t from = counts.batches;
    const std::uint64_t end =
        options.relative_error > 0.0 ? std::min(run.batches, end_of_round(from + 1)) : run.batches;
    std::atomic<std::uint64_t> next = from;
    std::atomic<bool> pauses = false;  // for what there is to be kept
    const auto workers = static_cast<std::size_t>(
        std::min<std::uint64_t>(static_cast<std::uint64_t>(thread_count()), end - from));
    // Threads take batches in runs, each with its own memory for the sums.
    parallel_for(workers, [&](std::size_t) {
      BatchSums sums;
      while (!stopped && !pauses) {
        const std::uint64_t i = next++;
        if (i >= end) break;
        sums.cells.assign(run.plan.layout.cells, {});
        sums.volume.assign(run.plan.layout.volume_cells, 0);
        sums.events = 0;
        const std::uint64_t first = run.first_photon(i, options.shard);
        const std::uint64_t count = std::min(run.batch_size, options.photons - first);
        if (run.scene.weight > 0.0f) photon::trace_batch(run.scene, run.plan, first, count, sums);
        const std::scoped_lock lock(mutex);
        add_batch(sums, count, counts);
        const double spent = static_cast<double>(counts.batches) / static_cast<double>(run.batches);
        const double past = options.seconds > 0.0 ? since(start) / options.seconds : 0.0;
        if (!report_progress(options.progress, std::min(1.0, std::max(spent, past))) || past >= 1.0)
          stopped = true;
        if (options.keep && since(kept) > keep_seconds) pauses = true;
      }
    });
    is_over = is_done(run, options, counts);
    counts.was_stopped = !is_over;
    if (options.keep && !is_over && (stopped || pauses)) {
      options.keep(counts);
      kept = Clock::now();
    }
  }
  counts.was_stopped = !is_over;
}

}  // namespace

PhotonCounts count_photons(const LayerStack& stack, const MonteCarloOptions& options) {
  const Run run = make_run(stack, options);
  PhotonCounts counts = make_counts(stack, options, run.scene, run.plan);
  trace_batches(run, options, counts);
  return counts;
}

PhotonCounts continue_photons(const LayerStack& stack, const MonteCarloOptions& options,
                              PhotonCounts counts) {
  const Run run = make_run(stack, options);
  const PhotonCounts none = make_counts(stack, options, run.scene, run.plan);
  check_counts(counts);
  static_cast<void>(merge_counts(none, counts));  // throws if they are of another run
  const std::uint64_t last = counts.batches == 0 ? 0 : counts.batches - 1;
  const std::uint64_t end =
      std::min(run.first_photon(last, options.shard) + run.batch_size, options.photons);
  const std::uint64_t photons =
      counts.batches == 0 ? 0
                          : last * run.batch_size + (end - run.first_photon(last, options.shard));
  if (counts.batches > run.batches || counts.photons != photons)
    throw InvalidInput("counts to go on from must be of this shard, but are of another");
  trace_batches(run, options, counts);
  return counts;
}

MonteCarloResult trace_photons(const LayerStack& stack, const MonteCarloOptions& options) {
  return summarize(count_photons(stack, options));
}

}  // namespace lamina
