// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace lamina {

/// A part of work that several machines share: part `index` of `count`.
struct Shard {
  int index = 0;  ///< in [0, count)
  int count = 1;  ///< >= 1
};

/// Numbers from `begin` up to `end`, which is not one of them.
struct IndexRange {
  std::int64_t begin = 0, end = 0;
  [[nodiscard]] std::int64_t size() const { return end - begin; }
  friend bool operator==(const IndexRange&, const IndexRange&) = default;
};

/// The part of `all` numbers from 0 on that a shard does: neighbours, and as many as other shards
/// or one more. `all` times the shard's count must be below 2^63.
[[nodiscard]] inline IndexRange range_of(const Shard& shard, std::int64_t all) {
  return {all * shard.index / shard.count, all * (shard.index + 1) / shard.count};
}

}  // namespace lamina
