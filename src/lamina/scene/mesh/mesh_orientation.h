// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lamina/scene/mesh/polygon_mesh.h"

namespace lamina {

/// Edges of a part that do not join faces two by two: one face is alone there, or more run one way
/// along it than the other.
struct OpenEdges {
  std::uint32_t part = 0;  ///< index into PolygonMesh::parts
  std::size_t count = 0;
  Vec3f place;                        ///< the middle of the first of them
  std::vector<std::uint32_t> opened;  ///< parts of the surfaces that these edges leave open
};

struct OrientedMesh {
  PolygonMesh mesh;
  std::size_t turned_faces = 0;     ///< wound against their neighbours, or against their normals
  std::size_t inside_out = 0;       ///< closed surfaces that were turned
  std::size_t open_inside_out = 0;  ///< surfaces without normals, open by little, that were turned
  std::size_t turned_normals = 0;   ///< faces whose normals pointed to their back
  bool is_closed = false;           ///< every edge joins faces two by two: there is an inside
  std::vector<OpenEdges> open;      ///< by part, unless it is closed
};

/// Makes faces and normals agree on what is outside.
///
/// Over each connected surface the faces are wound alike, as most of them are. A closed surface is
/// then turned if its signed volume is negative, unless it lies within another, as the inner wall
/// of a bottle does. An open one is turned if most of its normals contradict it, or, without any,
/// if its holes are less than a fifth of its area and the volume that it has with them closed is
/// negative. Normals that still contradict their face are turned.
///
/// A surface is closed if its faces run along every edge as often one way as the other, so that
/// each point in space is a whole number of times inside. An edge may have four faces, as where
/// bodies touch or folds of a scan lie on each other. Surfaces with one side only stay as they are
/// and are open.
///
/// Indices must be unified (unify_indices).
[[nodiscard]] OrientedMesh orient_mesh(PolygonMesh mesh);

}  // namespace lamina
