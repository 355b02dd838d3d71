// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamina {

/// Finds where numbers lie among ascending ends, by a table that says for each of as many parts of
/// [0, 1) as there are ends where to begin: in two steps in the mean, whatever the ends.
///
/// Source: [ChenAsau1974], the guide table.
class SegmentSearch {
 public:
  /// @param ends  ascending, in [0, 1]; at least one
  explicit SegmentSearch(std::span<const float> ends) : begin_(ends.size()) {
    std::size_t i = 0;
    for (std::size_t part = 0; part < begin_.size(); ++part) {
      const float low = static_cast<float>(part) / static_cast<float>(begin_.size());
      while (i + 1 < ends.size() && !(ends[i] > low)) ++i;
      begin_[part] = static_cast<std::uint32_t>(i);
    }
  }

  /// Index of the first of the ends that is above x; of the last if none is.
  ///
  /// @param ends  those of the constructor
  /// @param x     in [0, 1)
  [[nodiscard]] std::size_t find(std::span<const float> ends, float x) const {
    const auto part = static_cast<std::size_t>(x * static_cast<float>(begin_.size()));
    std::size_t i = begin_[std::min(part, begin_.size() - 1)];
    while (i > 0 && ends[i - 1] > x) --i;  // the part was rounded
    while (i + 1 < ends.size() && !(ends[i] > x)) ++i;
    return i;
  }

 private:
  std::vector<std::uint32_t> begin_;  ///< [part]
};

}  // namespace lamina
