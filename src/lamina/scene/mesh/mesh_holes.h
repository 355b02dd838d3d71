// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lamina/scene/mesh/polygon_mesh.h"

namespace lamina {

/// Closes what is open in some parts: each border, as at the neck of a head, gets a fan of
/// triangles around the mean of its vertices. They have normals of their own and no extent in
/// texture coordinates.
///
/// Indices must be unified (unify_indices).
///
/// @param closes  [part], whether its borders are closed
/// @return        how many borders were closed
std::size_t close_holes(PolygonMesh& mesh, const std::vector<bool>& closes);

}  // namespace lamina
