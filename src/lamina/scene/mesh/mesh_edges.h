// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamina {

/// An edge between two vertices of polygons, whatever its direction.
struct MeshEdge {
  std::array<std::uint32_t, 2> vertex{};
  std::uint32_t face_count = 0;
  /// The corners that it starts from, of the first two of its faces.
  std::array<std::uint32_t, 2> corner{};
};

struct MeshEdges {
  std::vector<MeshEdge> edges;
  std::vector<std::uint32_t> edge_of_corner;  ///< [corner], the edge to the next corner of its face
};

/// The edges of polygons.
///
/// @param face_begin  [face + 1], the first corner of each face and the end of the last.
/// @param vertices    [corner], a vertex < vertex_count.
[[nodiscard]] MeshEdges make_mesh_edges(std::span<const std::uint32_t> face_begin,
                                        std::span<const std::uint32_t> vertices,
                                        std::size_t vertex_count);

}  // namespace lamina
