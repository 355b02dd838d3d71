// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/vec.h"

namespace lamina {

/// Cuts a polygon, which need be neither flat nor convex, into triangles wound as it is.
///
/// Quadrilaterals are cut along the diagonal that leaves no triangle turned over, else the shorter
/// one; others by clipping ears, in the plane of their vector area.
///
/// @param points  its corners in order, at least 3. Beyond 2000 corners, a fan from the first.
/// @return        indices into `points`, points.size() - 2 triangles.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const Vec3> points);

}  // namespace lamina
