// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/scene/mesh/mesh.h"
#include "lamina/scene/mesh/polygon_mesh.h"

namespace lamina {

/// Counts over some faces of a mesh.
struct FaceCounts {
  std::size_t faces = 0, triangles = 0;
  std::size_t degenerate_faces = 0;   ///< without area
  std::size_t open_edges = 0;         ///< that do not join faces two by two
  std::size_t nonmanifold_edges = 0;  ///< of more than two
  Vec3f low, high;                    ///< corners of the smallest box [unit of the mesh]
};

/// A part of a mesh file.
struct PartReport {
  std::vector<std::string> labels;
  FaceCounts counts;
};

/// Report on a mesh before anything of it is mended.
struct MeshReport {
  FaceCounts counts;
  std::size_t vertices = 0;    ///< distinct positions
  std::size_t surfaces = 0;    ///< that edges connect
  bool is_closed = false;      ///< as it is for what is rendered (orient_mesh)
  std::size_t uv_islands = 0;  ///< of the texture coordinates
  std::size_t faces_without_uv = 0;
  int uv_sets = 0;
  std::vector<int> tiles;  ///< UDIM numbers that faces have their middle in, at most 1000
  bool has_colors = false;
  std::size_t creases = 0;
  std::vector<PartReport> parts;
};

/// Positions that are equal, or that differ by rounding along open edges, count as one.
[[nodiscard]] MeshReport report_mesh(PolygonMesh polygons);

/// The triangles of a mesh that is ready to be rendered, for reports on it: a part for each
/// material.
[[nodiscard]] PolygonMesh polygons_of(const Mesh& mesh);

/// Memory that a mesh takes when it is rendered, about: its numbers and 100 bytes a triangle for
/// the tree that rays go down.
[[nodiscard]] std::size_t rendering_memory(std::size_t vertices, std::size_t triangles);

}  // namespace lamina
