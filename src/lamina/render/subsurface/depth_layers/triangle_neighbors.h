// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace lamina {

inline constexpr std::uint32_t no_neighbor = std::numeric_limits<std::uint32_t>::max();

/// [triangle][edge] the triangle that shares it, or no_neighbor; edges from vertex 0 to 1, 1 to 2,
/// 2 to 0.
using TriangleNeighbors = std::vector<std::array<std::uint32_t, 3>>;

/// By the indices of vertices: seams between vertices at one place have no neighbours. Of more than
/// two triangles at an edge only two find each other.
[[nodiscard]] TriangleNeighbors find_triangle_neighbors(
    std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace lamina
