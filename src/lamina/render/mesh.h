// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lamina/core/memory_budget.h"
#include "lamina/render/polygon_mesh.h"
#include "lamina/render/scene.h"

namespace lamina {

enum class NormalSource {
  file,    ///< those of the file, smooth ones where it has none
  smooth,  ///< the mean of the faces around each position, weighted by their angle there
  flat,    ///< those of the faces
};

struct MeshOptions {
  Transform to_world;  ///< from the units of the file to mm
  int subdivision =
      0;  ///< Catmull-Clark steps, in [0, most_subdivisions]; they imply smooth normals
  NormalSource normals = NormalSource::file;
  MemoryBudget memory = {};  ///< that making the mesh may take
};

struct PreparedMesh {
  Mesh mesh;
  std::vector<std::string> warnings;  ///< one line each, that begins with the name of the mesh
};

/// Polygons made ready to be rendered: moved to the world, unified, oriented, subdivided, cut into
/// triangles, with a normal everywhere.
///
/// @param material_of_part  [part], what Mesh::material says of its triangles.
/// @throws InvalidInput if nothing is left, if the transform flattens the mesh, or if it lies
///         beyond 1e9 mm; FileError if it takes more memory than there may be.
[[nodiscard]] PreparedMesh make_mesh(PolygonMesh polygons, const MeshOptions& options,
                                     std::span<const std::uint32_t> material_of_part);

}  // namespace lamina
