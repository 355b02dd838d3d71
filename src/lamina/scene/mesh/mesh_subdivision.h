// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/scene/mesh/polygon_mesh.h"

namespace lamina {

/// At most this many times a mesh is subdivided.
inline constexpr int most_subdivisions = 6;

/// Edges that subdivision keeps sharp, beside those that a mesh names.
struct CreaseOptions {
  double angle = 0.0;       ///< between the normals of two faces, from which their edge is sharp
                            ///< [rad]; 0: none is
  float sharpness = 10.0f;  ///< of those [subdivision steps]
};

/// Polygons subdivided into quadrilaterals, each face into as many as it has corners, whose limit
/// is a smooth surface: bicubic B-splines wherever four quadrilaterals meet at every vertex.
///
/// Open borders, and edges that more than two faces share, become cubic B-spline curves; the corner
/// of a border that belongs to one face stays where it is. Texture coordinates are subdivided by
/// the same rules inside their islands, and linearly along seams, so that both sides of a seam
/// still meet. Normals are dropped. Indices must be unified (unify_indices), and the corners of a
/// mesh with texture coordinates must all have them.
///
/// An edge of sharpness s is kept, as a cubic B-spline curve, for s steps, and then smooth; where s
/// is no whole number the last step is a mean of both. Three such edges and more make a corner, one
/// alone fades out.
///
/// @param levels   in [0, most_subdivisions].
/// @param creases  of edges that the mesh does not name.
/// @throws InvalidInput if the result would have more than 400 million corners.
///
/// Source: [CatmullClark1978]; borders as [DeRose1998] §2, creases as §3.
[[nodiscard]] PolygonMesh subdivide_catmull_clark(PolygonMesh mesh, int levels,
                                                  const CreaseOptions& creases = {});

}  // namespace lamina
