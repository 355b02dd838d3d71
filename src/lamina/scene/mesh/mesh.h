// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/mesh_subdivision.h"
#include "lamina/scene/mesh/polygon_mesh.h"

namespace lamina {

/// A part of a mesh file with edges that do not join two faces.
struct OpenPart {
  std::string name;  ///< of its material, group or node; empty if it has none
  std::size_t edges = 0;
  Vec3f place;                           ///< of the first of them [mm]
  std::vector<std::uint32_t> materials;  ///< of the surfaces that are open there
};

/// Triangles with one vertex per distinct (position, normal, uv), in world space.
struct Mesh {
  std::string name;
  std::vector<Vec3f> positions;  ///< [vertex] [mm]
  std::vector<Vec3f> normals;    ///< [vertex], unit length
  std::vector<Vec2f> uvs;        ///< [vertex], v upward; empty if the mesh has none
  std::vector<Vec3f> colors;     ///< [vertex], linear; empty if the mesh has none
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> material;  ///< [triangle], an index into Scene::materials
  bool is_closed = false;               ///< every edge joins two faces: it has an inside
  std::vector<OpenPart> open_parts;     ///< why it is not closed, if that is known
};

/// Whether all surfaces of a mesh that a material is on have an inside.
[[nodiscard]] inline bool is_closed(const Mesh& mesh, std::uint32_t material) {
  const auto is_open = [&](const OpenPart& part) {
    return std::ranges::find(part.materials, material) != part.materials.end();
  };
  return mesh.is_closed ||
         (!mesh.open_parts.empty() && std::ranges::none_of(mesh.open_parts, is_open));
}

enum class NormalSource {
  file,    ///< those of the file, smooth ones where it has none
  smooth,  ///< the mean of the faces around each position, weighted by their angle there
  flat,    ///< those of the faces
};

/// Heights by which vertices move along their normals, after subdivision.
/// @return  [mm] at texture coordinates, of a face whose middle lies at `middle`
using Displacement = std::function<float(Vec2f uv, Vec2f middle)>;

struct MeshOptions {
  Transform to_world;  ///< from the units of the file to mm
  int subdivision =
      0;  ///< Catmull-Clark steps, in [0, most_subdivisions]; they imply smooth normals
  NormalSource normals = NormalSource::file;
  CreaseOptions creases = {};
  Displacement displacement = {};  ///< empty: none
  std::vector<bool> closes;        ///< [part], whether its holes are closed; empty: none are
  MemoryBudget memory = {};        ///< that making the mesh may take
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
