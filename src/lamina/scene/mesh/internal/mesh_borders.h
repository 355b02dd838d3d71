// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lamina/scene/mesh/polygon_mesh.h"

namespace lamina {

/// Joins vertices on open edges that lie within 1e-6 of the size of the mesh of each other, as the
/// two ends of a seam do that was computed twice. The first of them says where they are.
///
/// Vertices on edges of two faces stay apart, so that a thin sheet keeps its two sides however near
/// they are; so do the two ends of an edge, unless it is the one short edge of a face and open, as
/// at the pole of a lathe. Equal positions must have one index already.
///
/// @return  how many vertices went.
std::size_t join_borders(PolygonMesh& mesh);

}  // namespace lamina
