// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/mesh.h"

namespace lamina {

/// Zones of a material's surface by the distance to its sharp edges, where faces part by more than
/// 40 degrees. Light shines through an edge in a narrow line along it, so values along it are alike
/// and values across it are not.
class ZonesByCreases {
 public:
  /// @param spacing  of the places that are told apart [mm], > 0
  ZonesByCreases(const std::vector<Mesh>& meshes, std::uint32_t material, float spacing);

  /// The logarithm of 1 and the distance to the nearest edge over a quarter of the spacing, up to
  /// four spacings away; further on it stays.
  [[nodiscard]] float at(const Vec3f& position) const;

 private:
  void add_creases(const Mesh& mesh, std::uint32_t material);
  [[nodiscard]] std::uint64_t cube_of(const Vec3f& position, int dx, int dy, int dz) const;

  float unit_;                                           ///< [mm]
  std::vector<std::pair<std::uint64_t, Vec3f>> points_;  ///< on edges, by the cubes they lie in
};

}  // namespace lamina
