// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/photon_tallies.h"

#include <algorithm>
#include <cmath>

#include "lamina/core/error.h"
#include "lamina/scattering/photon_scene.h"

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

PhotonLayout make_photon_layout(const PhotonTallies& t, std::size_t layers) {
  const auto size = [](int count) { return static_cast<std::size_t>(std::max(count, 1)); };
  PhotonLayout layout;
  std::size_t next = PhotonLayout::first_layer + layers;
  const auto reserve = [&](std::size_t& first, std::size_t& cells, std::size_t per_side) {
    first = next;
    cells = per_side;
    next += 2 * per_side;
  };
  if (t.r.count > 0 || t.angles > 0)
    reserve(layout.ra, layout.ra_size, size(t.r.count) * size(t.angles));
  if (t.log_r.count > 0) reserve(layout.log_r, layout.log_r_size, size(t.log_r.count));
  if (t.bsdf_cosines > 0)
    reserve(
        layout.bsdf, layout.bsdf_size,
        (t.orders ? std::size_t{photon_orders} : 1) * size(t.bsdf_cosines) * size(t.bsdf_azimuths));
  if (t.orders) reserve(layout.order, layout.order_size, photon_orders * size(t.angles));
  if (t.path_length.count > 0) reserve(layout.path, layout.path_size, size(t.path_length.count));
  layout.detector = next;
  next += t.detectors.size();
  layout.direction = next;
  next += t.directions.size();
  layout.cells = next;
  if (t.r.count > 0 && t.depth.count > 0) {
    layout.rz_size = size(t.r.count) * size(t.depth.count);
    layout.volume_cells = layout.rz_size * (t.fluence ? 2 : 1);
  }
  return layout;
}

PhotonCounts merge(const PhotonCounts& a, const PhotonCounts& b) {
  if (a.run != b.run)
    throw InvalidInput("shards must be of one run, but are of \"" + a.run + "\" and \"" + b.run +
                       "\"");
  if (a.first.size() != b.first.size() || a.second.size() != b.second.size() ||
      a.volume_first.size() != b.volume_first.size() ||
      a.volume_second.size() != b.volume_second.size())
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
