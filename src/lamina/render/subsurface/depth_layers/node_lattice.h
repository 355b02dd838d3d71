// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "lamina/base/core/vec.h"

namespace lamina {

/// Nodes of a cubic lattice over a box.
class NodeLattice {
 public:
  /// @param spacing  of nodes [mm]; made wider if there were more than `most_nodes`
  NodeLattice(const Vec3f& low, const Vec3f& high, float spacing, double most_nodes);

  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
           static_cast<std::size_t>(size_[2]);
  }
  [[nodiscard]] float spacing() const { return spacing_; }
  struct Nearest {
    std::size_t node;
    Vec3f position;
  };
  [[nodiscard]] Nearest nearest(const Vec3f& p) const {
    const Vec3f at = (p - low_) * per_spacing_ + Vec3f{0.5f, 0.5f, 0.5f};
    const int x = within(at.x, 0), y = within(at.y, 1), z = within(at.z, 2);
    return {index(x, y, z), low_ + spacing_ * Vec3f{static_cast<float>(x), static_cast<float>(y),
                                                    static_cast<float>(z)}};
  }
  [[nodiscard]] Vec3f position(std::size_t node) const {
    const auto nx = static_cast<std::size_t>(size_[0]), ny = static_cast<std::size_t>(size_[1]);
    return low_ + spacing_ * Vec3f{static_cast<float>(node % nx),
                                   static_cast<float>(node / nx % ny),
                                   static_cast<float>(node / (nx * ny))};
  }
  /// The eight nodes around a point and their weights, trilinear.
  struct Corners {
    std::array<std::size_t, 8> node;
    std::array<float, 8> weight;
  };
  [[nodiscard]] Corners corners(const Vec3f& p) const {
    const Vec3f at = (p - low_) * per_spacing_;
    std::array<int, 3> cell;
    std::array<float, 3> f;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float x = at[static_cast<int>(axis)];
      cell[axis] = static_cast<int>(std::clamp(x, 0.0f, static_cast<float>(size_[axis] - 2)));
      f[axis] = std::clamp(x - static_cast<float>(cell[axis]), 0.0f, 1.0f);
    }
    const std::size_t first = index(cell[0], cell[1], cell[2]);
    const auto row = static_cast<std::size_t>(size_[0]);
    const std::size_t layer = row * static_cast<std::size_t>(size_[1]);
    Corners corners;
    for (std::size_t i = 0; i < 8; ++i) {
      const std::size_t x = i & 1, y = i >> 1 & 1, z = i >> 2;
      corners.node[i] = first + x + row * y + layer * z;
      corners.weight[i] =
          (x ? f[0] : 1.0f - f[0]) * (y ? f[1] : 1.0f - f[1]) * (z ? f[2] : 1.0f - f[2]);
    }
    return corners;
  }

 private:
  [[nodiscard]] int within(float x, int axis) const {
    const int last = size_[static_cast<std::size_t>(axis)] - 1;
    return static_cast<int>(std::clamp(x, 0.0f, static_cast<float>(last)));
  }
  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(size_[0]) *
               (static_cast<std::size_t>(y) +
                static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(z));
  }

  Vec3f low_;
  float spacing_, per_spacing_;
  std::array<int, 3> size_;
};

}  // namespace lamina
