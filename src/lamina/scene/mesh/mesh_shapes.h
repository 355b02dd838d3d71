// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/polygon_mesh.h"

namespace lamina {

// Shapes for tests and first scenes, around the origin, with normals and texture coordinates.
// Every size must be > 0, every tessellation in [1, most_tessellation].

inline constexpr int most_tessellation = 4096;

/// In the xy plane, facing +z; u along x, v along y. tessellation² quadrilaterals.
[[nodiscard]] PolygonMesh make_rectangle(double width, double height, int tessellation);

/// In the xy plane, facing +z; texture as on the square around it. `tessellation` sectors, at
/// least 3.
[[nodiscard]] PolygonMesh make_disk(double radius, int tessellation);

/// Poles on the y axis; u runs along the equator from -z over -x, v from the south pole to the
/// north pole. `tessellation` rows (at least 2), twice as many columns.
[[nodiscard]] PolygonMesh make_sphere(double radius, int tessellation);

/// Flat faces, each with the whole texture and tessellation² quadrilaterals.
[[nodiscard]] PolygonMesh make_box(const Vec3& size, int tessellation);

/// A closed smooth surface with lobes and hollows, a test of what curvature does to light below the
/// surface: radius * (1 + sum of Legendre polynomials about fixed axes), so that the mean of the
/// radius over all directions is `radius`. 6 * tessellation² quadrilaterals; 50 gives 30 000
/// triangles. Texture coordinates form six islands in three columns and two rows.
[[nodiscard]] PolygonMesh make_bumpy_sphere(double radius, int tessellation);

/// A sculpted head on its plinth, facing +z, closed, without texture coordinates. `height` is that
/// of the whole, `tessellation` the cells of the sculpting grid along it, at least 16.
[[nodiscard]] PolygonMesh make_bust(double height, int tessellation);

}  // namespace lamina
