// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/solve/scattering/heterogeneous/blurs/cell_graph.h"

namespace lamina::detail {

/// How far light is followed through a body [mm].
inline constexpr float thin_reach = 20.0f;

/// Bends of a surface are those over such a part of a slab's thickness, the standard deviation of a
/// Gaussian on the surface.
inline constexpr double bend_width = 0.6;

/// A cell as others see it.
struct FacingCell {
  Vec3f position;       ///< mean over the cell [mm]
  Vec3f normal;         ///< mean, so shorter than 1 where the surface bends
  float area = 0.0f;    ///< [mm²]
  float radius = 0.0f;  ///< of a ball around the position that holds the cell [mm]
  /// How the surface bends around it, as slabs of 1, 2, 4, 8 and 16 mm see it: minus the logarithm
  /// of the mean normal's length over a third of that, negative in hollows.
  std::array<float, 5> bend{};
};

/// A way through the body between two cells.
///
/// If the surfaces around both are flat as far as they are apart they bound a slab, whose normal is
/// the mean of theirs, the far one's turned: what passes is its T. On a ball it is R of a
/// half-space at the distance through the body, exactly so for cells that light leaves as soon as
/// it gets there; R over the surface has part of that already. Between these shapes both are
/// blended.
struct FacingPair {
  float thickness = 0.0f;    ///< of the slab [mm]
  float lateral2 = 0.0f;     ///< squared distance along it [mm²]
  float distance2 = 0.0f;    ///< squared distance through the body [mm²]
  float opening = 0.0f;      ///< squared cosine of half the angle between the normals
  float of_slab = 0.0f;      ///< share of T
  float of_distance = 0.0f;  ///< share of R
};

/// The shares are 0 if there is no way: cells that do not lie below each other.
/// Source: [DonnerJensen2005] Eq. 27 for the blend of wedges; docs/subsurface_texture_space.md.
[[nodiscard]] FacingPair facing_pair(const FacingCell& to, const FacingCell& from);

/// Cells of a surface that see each other through the body. Far cells are coarse: the farther, the
/// coarser.
struct FacingCells {
  std::size_t level = 0;              ///< of the graph: the cells that take light
  std::vector<std::size_t> begin;     ///< [level - FacingCells::level] of `cells`; one more ends it
  std::vector<FacingCell> cells;      ///< of `level` and of all coarser ones
  std::vector<std::uint32_t> taking;  ///< cells of `level` that see any
  std::vector<std::size_t> first;     ///< [taking], of `from`; one more entry ends the last
  std::vector<std::uint32_t> from;    ///< indices of `cells`
};

/// @param positions, normals  [cell of the finest level]; normals are of unit length and outward
/// @param spacing             cells that take light are about as wide, unless all are wider [mm]
[[nodiscard]] FacingCells find_facing_cells(const CellGraph& graph,
                                            std::span<const Vec3f> positions,
                                            std::span<const Vec3f> normals, float spacing);

}  // namespace lamina::detail
