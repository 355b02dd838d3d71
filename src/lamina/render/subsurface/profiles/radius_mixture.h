// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>

#include "lamina/render/subsurface/profiles/profile_table.h"

namespace lamina {

/// Radii drawn from the sum of several profiles on one grid.
///
/// One number gives a radius by the distribution of the whole sum, so that samples spread over the
/// numbers are spread over the radii, whichever profile is strong where.
template <int N>
class RadiusMixture {
 public:
  /// @param light   of the table: a band of what it reflects, or ProfileTable::all_bands, passing
  /// @param weight  over those of all others together; nothing is drawn by one of 0
  void add(const ProfileTable<N>& table, int light, float weight) {
    if (!(weight > 0.0f)) return;
    assert(count_ < sources_.size());
    sources_[count_++] = {&table, light, weight};
    total_ += weight;
  }

  /// [mm], for u in [0, 1).
  [[nodiscard]] float sample_radius(float u) const {
    if (count_ == 0) return 0.0f;
    const ProfileTable<N>& grid = *sources_[0].table;
    const auto within = [&](std::size_t ring) {
      return mean([&](const Source& s) { return s.table->share_within(ring, s.light); });
    };
    std::size_t low = 0, high = grid.rings() - 1;  // the first ring that ends beyond u
    while (low < high) {
      const std::size_t middle = (low + high) / 2;
      if (within(middle) > u)
        high = middle;
      else
        low = middle + 1;
    }
    const float before = low > 0 ? within(low - 1) : 0.0f;
    const float share = std::max(within(low) - before, 1e-12f);
    return grid.radius_in(low, std::clamp((u - before) / share, 0.0f, 1.0f));
  }

  /// Density of points in the plane around the exit [1/mm²].
  [[nodiscard]] float density(float r) const {
    if (count_ == 0) return 0.0f;
    const std::size_t ring = sources_[0].table->ring(r);
    return mean([&](const Source& s) { return s.table->density_in(ring, s.light); });
  }

 private:
  struct Source {
    const ProfileTable<N>* table;
    int light;
    float weight;
  };
  template <class Value>
  [[nodiscard]] float mean(const Value& value) const {
    float sum = 0.0f;
    for (std::size_t i = 0; i < count_; ++i)
      sum += sources_[i].weight / total_ * value(sources_[i]);
    return sum;
  }

  std::array<Source, 4 * N + 2> sources_;  ///< two slabs, and each band's two or four half-spaces
  std::size_t count_ = 0;
  float total_ = 0.0f;
};

}  // namespace lamina
