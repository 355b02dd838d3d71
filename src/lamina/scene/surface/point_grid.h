// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/vec.h"

namespace lamina {

/// Points of a surface, found by place.
class PointGrid {
 public:
  struct Place {
    Vec3f position, normal;
  };
  static constexpr int capacity = 48;  ///< of points within reach; further ones are left out
  /// Coefficients of each nearby value in the fit of a plane through them.
  struct Weights {
    std::array<std::uint32_t, capacity> point;
    std::array<float, capacity> weight;
    std::size_t count = 0;
  };

  PointGrid() = default;
  /// @param reach  of the fit [mm], > 0
  PointGrid(std::span<const Place> places, float reach);

  struct Near {
    std::array<std::uint32_t, capacity> point;
    std::array<Vec3f, capacity> offset;  ///< from the position [mm]
    std::array<float, capacity> facing;  ///< cosine between the normals
    std::size_t count = 0;
  };
  /// Points within reach of a position that face less than 75 degrees away from a normal.
  [[nodiscard]] Near near(const Vec3f& position, const Vec3f& normal) const;

  /// Weights of a value at a point from those of points within reach that face the same way: a
  /// straight line by weighted least squares, so that values which rise evenly along the surface
  /// come out as they are. They add up to 1; there are none if no point is near.
  [[nodiscard]] Weights weights_at(const Vec3f& position, const Vec3f& normal) const;

 private:
  [[nodiscard]] std::size_t slot(std::int32_t x, std::int32_t y, std::int32_t z) const;

  std::array<std::vector<float>, 6> places_;  ///< rows of positions and normals, by slots
  float reach_ = 1.0f;
  std::vector<std::uint32_t> first_;  ///< [slot], into places_, and the end
  std::vector<std::uint32_t> point_;  ///< [place], as the caller numbered them
};

}  // namespace lamina
