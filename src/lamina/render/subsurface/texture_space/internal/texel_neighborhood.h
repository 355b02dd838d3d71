// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "lamina/render/subsurface/texture_space/internal/texture_atlas.h"

namespace lamina {

/// Finds texels by their place in space: boxes of the width of some texels, sorted.
class TexelNeighborhood {
 public:
  explicit TexelNeighborhood(std::span<const AtlasTexel> texels) : texels_(texels) {
    double area = 0.0;
    for (const AtlasTexel& texel : texels) area += static_cast<double>(texel.area);
    if (!texels.empty())
      width_ = 2.0f * static_cast<float>(std::sqrt(area / static_cast<double>(texels.size())));
    entries_.reserve(texels.size());
    for (std::uint32_t i = 0; i < texels.size(); ++i)
      entries_.push_back({key(box(texels[i].position)), i});
    std::ranges::sort(entries_, {}, &Entry::key);
  }

  /// Calls visit(texel, squared distance) for all texels within a radius [mm].
  template <class Visit>
  void for_near(const Vec3f& place, float radius, const Visit& visit) const {
    const Box low = box(place - Vec3f{radius, radius, radius});
    const Box high = box(place + Vec3f{radius, radius, radius});
    for (std::int64_t z = low.z; z <= high.z; ++z)
      for (std::int64_t y = low.y; y <= high.y; ++y)
        for (std::int64_t x = low.x; x <= high.x; ++x) {
          const std::uint64_t wanted = key({x, y, z});
          for (auto at = std::ranges::lower_bound(entries_, wanted, {}, &Entry::key);
               at != entries_.end() && at->key == wanted; ++at) {
            const Vec3f offset = texels_[at->texel].position - place;
            const float distance2 = dot(offset, offset);
            if (distance2 <= radius * radius) visit(at->texel, distance2);
          }
        }
  }

 private:
  struct Entry {
    std::uint64_t key;
    std::uint32_t texel;
  };
  struct Box {
    std::int64_t x, y, z;
  };
  [[nodiscard]] Box box(const Vec3f& p) const {
    const auto along = [&](float x) { return static_cast<std::int64_t>(std::floor(x / width_)); };
    return {along(p.x), along(p.y), along(p.z)};
  }
  /// Boxes a million apart share a key, which only costs time.
  [[nodiscard]] static std::uint64_t key(const Box& b) {
    constexpr std::uint64_t mask = (1u << 21u) - 1u;
    return (static_cast<std::uint64_t>(b.x) & mask) |
           (static_cast<std::uint64_t>(b.y) & mask) << 21u |
           (static_cast<std::uint64_t>(b.z) & mask) << 42u;
  }

  std::span<const AtlasTexel> texels_;
  float width_ = 1.0f;
  std::vector<Entry> entries_;
};

}  // namespace lamina
