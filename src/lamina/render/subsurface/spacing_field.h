// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/vec.h"

namespace lamina {

/// How far apart samples of the light on a surface may be: close around places that are seen, and
/// twice as far at each level away from there. A cell is never seen from them in more than about
/// 1/16 sr, so that summing its light at its middle errs as little as the sum of far samples does.
class SpacingField {
 public:
  static constexpr int levels = 7;

  /// Makes a field of equal spacing [mm].
  explicit SpacingField(float spacing) : spacing_(spacing) {}
  /// @param seen     places [mm], any number
  /// @param spacing  of samples there [mm], > 0
  /// @param margin   around the places that counts as seen [mm]; at least 8 spacings are
  SpacingField(std::span<const Vec3f> seen, float spacing, float margin);

  /// Spacing at a place over that where it is seen, as a power of 2 in [0, levels).
  [[nodiscard]] int level(const Vec3f& place) const;
  [[nodiscard]] float spacing(int level) const {
    return spacing_ * static_cast<float>(std::uint32_t{1} << level);
  }
  /// A length over which the level changes by about 1 at most [mm].
  [[nodiscard]] float width(int level) const {
    return width_ * static_cast<float>(std::uint32_t{1} << level);
  }
  [[nodiscard]] bool is_even() const { return !(width_ > 0.0f); }

 private:
  float spacing_;
  float width_ = 0.0f;  ///< of a cube of the first level [mm]; 0: the same everywhere
  /// Cubes that hold a place that is seen, or touch one: [level], ascending.
  std::array<std::vector<std::uint64_t>, levels - 1> near_;
};

}  // namespace lamina
