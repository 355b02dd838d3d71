// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/parallel_chunks.h"
#include "lamina/scene/surface/point_grid.h"

namespace lamina {

/// Places of a surface and their neighbours along it: what is spread from each to its neighbours,
/// again and again, comes far over the surface, but not across edges, gaps and thin parts.
class PlaceGraph {
 public:
  struct Place {
    PointGrid::Place at;
    float spacing;      ///< of places around it [mm], a power of 2 times the least
    float zone = 0.0f;  ///< places of zones that differ by more than .5 hardly mix
  };

  PlaceGraph() = default;
  /// @param places  none or more
  explicit PlaceGraph(std::span<const Place> places);

  /// Spreads values, sums over places, by one step: as a Gaussian of `step_width` spacings would.
  /// What all places have together stays the same.
  template <class Value>
  [[nodiscard]] std::vector<Value> spread(const std::vector<Value>& values) const {
    std::vector<Value> result(values.size());
    constexpr std::size_t chunk = 256;
    parallel_chunks(values.size(), chunk, [&](std::size_t i) {
      for (std::size_t k = first_[i]; k < first_[i + 1]; ++k)
        result[i] += share_[k] * values[from_[k]];
    });
    return result;
  }

  /// About how many places a value has come to after some steps.
  [[nodiscard]] static double places_reached(int steps);

  /// Weights of the values of places at a point of the surface, as PointGrid::weights_at.
  [[nodiscard]] PointGrid::Weights weights_at(const Vec3f& position, const Vec3f& normal) const;

 private:
  std::vector<PointGrid> grids_;  ///< [level of spacing], of places of that level, and around it
  std::vector<std::vector<std::uint32_t>> places_of_;  ///< [level][place of its grid]
  std::vector<std::size_t> first_;                     ///< [place], and the end
  std::vector<std::uint32_t> from_;
  std::vector<float> share_;  ///< of what is at `from_` that comes here
};

}  // namespace lamina
