// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/depth_layers/node_lattice.h"

#include <cmath>

namespace lamina {

NodeLattice::NodeLattice(const Vec3f& low, const Vec3f& high, float spacing, double most) {
  const Vec3f extent = high - low;
  const double volume =
      static_cast<double>(extent.x) * static_cast<double>(extent.y) * static_cast<double>(extent.z);
  spacing_ = std::max({spacing, static_cast<float>(std::cbrt(volume / most)),
                       1e-3f * std::max({extent.x, extent.y, extent.z, 1e-6f})});
  per_spacing_ = 1.0f / spacing_;
  // Half a spacing beyond the box, so that points on its border have nodes around them.
  low_ = low - Vec3f{0.5f, 0.5f, 0.5f} * spacing_;
  for (std::size_t axis = 0; axis < 3; ++axis)
    size_[axis] = static_cast<int>(std::ceil(extent[static_cast<int>(axis)] / spacing_)) + 2;
}

}  // namespace lamina
