// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/walk_field.h"

#include <limits>

#include "lamina/render/surface_point.h"

namespace lamina {
NodeLattice::NodeLattice(const Vec3f& low, const Vec3f& high, float spacing, double most) {
  const Vec3f extent = high - low;
  const double volume =
      static_cast<double>(extent.x) * static_cast<double>(extent.y) * static_cast<double>(extent.z);
  spacing_ = std::max({spacing, static_cast<float>(std::cbrt(volume / most)),
                       1e-3f * std::max({extent.x, extent.y, extent.z, 1e-6f})});
  // Half a spacing beyond the box, so that points on its border have nodes around them.
  low_ = low - Vec3f{0.5f, 0.5f, 0.5f} * spacing_;
  for (std::size_t axis = 0; axis < 3; ++axis)
    size_[axis] = static_cast<int>(std::ceil(extent[static_cast<int>(axis)] / spacing_)) + 2;
}

NodeLattice::Corners NodeLattice::corners(const Vec3f& p) const {
  const Vec3f at = (p - low_) * (1.0f / spacing_);
  std::array<int, 3> cell;
  std::array<float, 3> f;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float x = at[static_cast<int>(axis)];
    cell[axis] = static_cast<int>(std::clamp(x, 0.0f, static_cast<float>(size_[axis] - 2)));
    f[axis] = std::clamp(x - static_cast<float>(cell[axis]), 0.0f, 1.0f);
  }
  Corners corners;
  for (int i = 0; i < 8; ++i) {
    const int x = i & 1, y = i >> 1 & 1, z = i >> 2;
    const auto k = static_cast<std::size_t>(i);
    corners.node[k] = index(cell[0] + x, cell[1] + y, cell[2] + z);
    corners.weight[k] =
        (x ? f[0] : 1.0f - f[0]) * (y ? f[1] : 1.0f - f[1]) * (z ? f[2] : 1.0f - f[2]);
  }
  return corners;
}

SafeDistances::SafeDistances(const RayGeometry& geometry, const std::vector<Mesh>& meshes,
                             const NodeLattice& lattice)
    : geometry_(geometry), meshes_(meshes), lattice_(lattice), nodes_(lattice_.count()) {}

SafeDistances::Node SafeDistances::node_at(std::size_t node) const {
  return nodes_.at(node, [&](std::size_t i) -> Node {
    // Far inside, where all of the surface is as near, a query is slow and not needed.
    const float reach = 5.0f * lattice_.spacing();
    const Hit hit = geometry_.closest_point(lattice_.position(i), reach);
    if (!hit.is_hit()) return {reach, {}};
    return {0.9f * hit.distance, make_surface_point(meshes_, hit, 0.0f).smooth_normal};
  });
}

}  // namespace lamina
