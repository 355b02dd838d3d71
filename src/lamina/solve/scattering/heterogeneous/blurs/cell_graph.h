// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/vec.h"

namespace lamina {

/// A small piece of a curved surface, one cell of a grid of texture coordinates.
struct GraphCell {
  Vec3f position;           ///< [mm]
  float area = 0.0f;        ///< [mm²], > 0
  std::uint32_t chart = 0;  ///< cells of one chart share a grid
  std::int32_t x = 0, y = 0;
};

/// A way between two cells: as much light flows along it as their densities differ, times its
/// conductance. Two squares side by side have a conductance of 1, whatever their size.
struct CellLink {
  std::uint32_t from = 0, to = 0;
  float conductance = 0.0f;  ///< > 0
};

/// Cells of about one size and the ways between them. Several links may join the same cells.
struct CellLevel {
  struct Neighbor {
    std::uint32_t cell;
    float rate;  ///< conductance over area, times half the typical area
  };
  float typical_area = 0.0f;         ///< [mm²]
  std::vector<float> area;           ///< [cell] [mm²]
  std::vector<std::uint32_t> first;  ///< [cell], of its neighbours; one more entry ends the last
  std::vector<Neighbor> neighbors;
  std::vector<float> rate;            ///< [cell]: sum of the rates of its neighbours
  std::vector<std::uint32_t> parent;  ///< [cell] on the next level; empty on the last
  /// [cell of the next level], first of `children`; one more entry ends the last
  std::vector<std::uint32_t> first_child;
  std::vector<std::uint32_t> children;
};

/// A surface as cells, from fine to coarse: each level has cells of about four of the one before.
struct CellGraph {
  std::vector<CellLevel> levels;
};

/// Cells in one square of two by two share a parent; one with too few children joins the neighbour
/// to which it is tied best.
///
/// Links of the fine level between two parents become one: fluxes are kept for gradients along the
/// line between them. No cell exchanges more than four of its kind would; where cells are far
/// smaller than is typical light is slowed down.
///
/// @param links         each once.
/// @param largest_area  levels end where a typical cell has as much [mm²], or few are left.
[[nodiscard]] CellGraph make_cell_graph(std::span<const GraphCell> cells,
                                        std::span<const CellLink> links, double largest_area);

}  // namespace lamina
