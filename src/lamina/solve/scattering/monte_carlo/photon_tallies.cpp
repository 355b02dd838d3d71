// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/photon_tallies.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/core/checked_size.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/solve/scattering/monte_carlo/internal/photon_scene.h"

namespace lamina {

void add(WideSum& a, WideSum b) {
  a.low += b.low;
  a.high += b.high + (a.low < b.low ? 1u : 0u);
}

double to_double(WideSum sum, int scale) {
  const bool is_negative = (sum.high >> 63) != 0;
  if (is_negative) {
    sum.low = ~sum.low + 1;
    sum.high = ~sum.high + (sum.low == 0 ? 1u : 0u);
  }
  const double magnitude = std::ldexp(static_cast<double>(sum.high), 64 - scale) +
                           std::ldexp(static_cast<double>(sum.low), -scale);
  return is_negative ? -magnitude : magnitude;
}

void check_memory(const PhotonLayout& layout, std::size_t batches) {
  constexpr double largest = 4.0 * 1024.0 * 1024.0 * 1024.0;
  const auto in_flight = static_cast<double>(batches);
  const double bytes = static_cast<double>(layout.cells) *
                           (2.0 * sizeof(WideSum) + sizeof(photon::BatchSums::Cell) * in_flight) +
                       static_cast<double>(layout.volume_cells) *
                           (2.0 * sizeof(WideSum) + sizeof(std::int64_t) * in_flight);
  if (bytes <= largest) return;
  PlainTextStream message;
  message.precision(3);
  message << "tallies: the grids must fit in 4 GiB, but need " << bytes / (1024.0 * 1024.0 * 1024.0)
          << " GiB; take fewer bins";
  throw InvalidInput(message.str());
}

PhotonLayout make_photon_layout(const PhotonTallies& t, std::size_t layers) {
  const auto size = [](int count) { return static_cast<std::size_t>(std::max(count, 1)); };
  const std::size_t orders = t.orders ? std::size_t{photon_orders} : 1;
  PhotonLayout layout;
  std::size_t next = checked_sum("tallies: layers", {PhotonLayout::first_layer, layers});
  const auto reserve = [&](const std::string& name, std::size_t& first, std::size_t& cells,
                           std::initializer_list<std::size_t> counts) {
    first = next;
    cells = checked_product(name, counts);
    next = checked_sum("tallies: all grids", {next, cells, cells});
  };
  if (t.r.count > 0 || t.angles > 0)
    reserve("tallies: the grid of r and angle", layout.ra, layout.ra_size,
            {size(t.r.count), size(t.angles)});
  if (t.log_r.count > 0)
    reserve("tallies: the grid of log_r", layout.log_r, layout.log_r_size,
            {size(t.log_r.count) + 2});
  if (t.bsdf_cosines > 0)
    reserve("tallies: the grid of the bsdf", layout.bsdf, layout.bsdf_size,
            {orders, size(t.bsdf_cosines), size(t.bsdf_azimuths)});
  if (t.orders)
    reserve("tallies: the grid of orders", layout.order, layout.order_size,
            {orders, size(t.angles)});
  if (t.path_length.count > 0)
    reserve("tallies: the grid of path_length", layout.path, layout.path_size,
            {size(t.path_length.count)});
  const bool has_time = t.time.count > 0;
  if (has_time) {
    reserve("tallies: mean paths of the layers", layout.flight, layout.flight_size,
            {checked_sum("tallies: layers", {1, layers}), 2});
    reserve("tallies: the grid of r and time", layout.time, layout.time_size,
            {size(t.r.count), size(t.time.count)});
  }
  const std::size_t parts = t.frequencies.size() * modulation_parts;
  if (parts > 0)
    reserve("tallies: the grid of r and frequency", layout.modulation, layout.modulation_size,
            {size(t.r.count), parts});
  const auto reserve_detectors = [&](std::size_t& first, std::size_t cells) {
    first = next;
    next = checked_sum("tallies: detectors",
                       {next, checked_product("tallies: detectors", {t.detectors.size(), cells})});
  };
  reserve_detectors(layout.detector, 1);
  reserve_detectors(layout.detector_time, has_time ? size(t.time.count) : 0);
  reserve_detectors(layout.detector_modulation, parts);
  layout.direction = next;
  layout.cells = checked_sum("tallies: directions", {layout.direction, t.directions.size()});
  if (t.r.count > 0 && t.depth.count > 0) {
    const std::string name = "tallies: the grid of r and depth";
    layout.rz_size = checked_product(name, {size(t.r.count), size(t.depth.count)});
    layout.volume_cells = checked_product(name, {layout.rz_size, t.fluence ? 2u : 1u});
  }
  check_memory(layout, 0);
  return layout;
}

void check_counts(const PhotonCounts& counts) {
  photon::check_tallies(counts.tallies);
  const PhotonLayout layout = make_photon_layout(counts.tallies, counts.layers);
  const auto require = [](bool holds, const char* rule) {
    if (!holds) throw InvalidInput(rule);
  };
  require(counts.layers >= 1, "counts must have at least one layer, but have none");
  require(counts.specular >= 0.0 && counts.specular <= 1.0,
          "the specular reflectance of counts must lie in [0, 1], but does not");
  require(counts.length_unit > 0.0 && counts.length_unit <= 1e30,
          "the unit of length of counts must lie in (0, 1e30] mm, but does not");
  require(counts.batches <= counts.photons, "no batch of photons may be empty, but one is");
  require(counts.first.size() == layout.cells && counts.second.size() == layout.cells &&
              counts.volume_first.size() == layout.volume_cells &&
              counts.volume_second.size() == layout.volume_cells,
          "counts must have a sum for each cell of their tallies, but have not");
}

PhotonCounts merge_counts(const PhotonCounts& a, const PhotonCounts& b) {
  if (a.run != b.run)
    throw InvalidInput("shards must be of one run, but are of \"" + a.run + "\" and \"" + b.run +
                       "\"");
  if (a.tallies != b.tallies || a.layers != b.layers || a.specular != b.specular ||
      a.has_random_specular != b.has_random_specular || a.length_unit != b.length_unit)
    throw InvalidInput("shards must have the same tallies, but have not");
  PhotonCounts sum = a;
  sum.photons += b.photons;
  sum.batches += b.batches;
  sum.events += b.events;
  sum.was_stopped = a.was_stopped || b.was_stopped;
  const auto add_all = [](std::vector<WideSum>& to, const std::vector<WideSum>& from) {
    for (std::size_t i = 0; i < to.size(); ++i) add(to[i], from[i]);
  };
  add_all(sum.first, b.first);
  add_all(sum.second, b.second);
  add_all(sum.volume_first, b.volume_first);
  add_all(sum.volume_second, b.volume_second);
  return sum;
}

}  // namespace lamina
