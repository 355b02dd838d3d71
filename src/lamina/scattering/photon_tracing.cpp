// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/photon_tracing.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>

#include "lamina/core/error.h"
#include "lamina/core/number_text.h"
#include "lamina/core/parallel.h"
#include "lamina/scattering/photon_scene.h"

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
    add(counts.volume_second[i],
        wide(static_cast<Wide>(std::ldexp(part * part, photon::volume_square_scale))));
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
  name << "photons " << options.photons << ", seed " << options.seed << ", incidence "
       << (options.incidence.is_diffuse ? -1.0 : options.incidence.theta) << ", beam "
       << static_cast<int>(options.beam.shape) << ' ' << options.beam.radius << ", max_events "
       << options.max_events << ", roulette_weight " << options.roulette_weight << ", ior "
       << stack.ior_above() << ' ' << stack.ior_below() << ", ground " << stack.ground().reflectance
       << ' ' << stack.ground().top.roughness;
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

}  // namespace

PhotonCounts count_photons(const LayerStack& stack, const MonteCarloOptions& options) {
  photon::check_tallies(options.tallies);
  const Scene scene = photon::make_scene(stack, options);
  const TallyPlan plan =
      photon::make_tally_plan(options.tallies, stack.layers().size(), scene.length_unit);
  check_memory(plan.layout, static_cast<std::size_t>(thread_count()));
  PhotonCounts counts = make_counts(stack, options, scene, plan);

  const std::uint64_t size = batch_size(options.photons);
  const std::uint64_t batches = (options.photons + size - 1) / size;
  const auto shards = static_cast<std::uint64_t>(options.shard.count);
  const auto shard = static_cast<std::uint64_t>(options.shard.index);
  const std::uint64_t mine = batches > shard ? (batches - shard + shards - 1) / shards : 0;

  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  std::mutex mutex;
  std::atomic<bool> stopped = false;
  // Whether the run is precise enough is asked between rounds only, which double, so that the
  // answer does not depend on the order in which batches finish.
  std::uint64_t done = 0;
  std::uint64_t round = options.relative_error > 0.0 ? std::min<std::uint64_t>(mine, 16) : mine;
  while (done < mine && !stopped) {
    const std::uint64_t from = done;
    // Threads take batches in runs, each with its own memory for the sums.
    std::atomic<std::uint64_t> next = from;
    const auto workers = static_cast<std::size_t>(
        std::min<std::uint64_t>(static_cast<std::uint64_t>(thread_count()), round));
    parallel_for(workers, [&](std::size_t) {
      BatchSums sums;
      for (std::uint64_t i = next++; i < from + round && !stopped; i = next++) {
        sums.cells.assign(plan.layout.cells, {});
        sums.volume.assign(plan.layout.volume_cells, 0);
        sums.events = 0;
        const std::uint64_t first = (shard + i * shards) * size;
        const std::uint64_t count = std::min(size, options.photons - first);
        if (scene.weight > 0.0f) photon::trace_batch(scene, plan, first, count, sums);
        const std::scoped_lock lock(mutex);
        add_batch(sums, count, counts);
        const double spent = static_cast<double>(counts.batches) / static_cast<double>(mine);
        const double past = options.seconds > 0.0 ? elapsed() / options.seconds : 0.0;
        if (!report(options.progress, std::min(1.0, std::max(spent, past)))) stopped = true;
        if (past >= 1.0) stopped = true;
      }
    });
    done += round;
    if (options.relative_error > 0.0) {
      if (done < mine && is_precise(counts, options.relative_error)) break;
      round = std::min(done, mine - done);
    }
  }
  counts.was_stopped = stopped && counts.batches < mine;
  return counts;
}

MonteCarloResult trace_photons(const LayerStack& stack, const MonteCarloOptions& options) {
  return summarize(count_photons(stack, options));
}

}  // namespace lamina
