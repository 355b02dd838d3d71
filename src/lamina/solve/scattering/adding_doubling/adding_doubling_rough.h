// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_matrix.h"
#include "lamina/solve/scattering/adding_doubling/direction_grid.h"

namespace lamina::detail {

/// A rough boundary on a direction grid, for one azimuthal mode and from both sides.
///
/// From one extra node to another (a beam, a direction to look from) only light counts that meets
/// two facets or more: what a single one sends there has a closed form for each azimuth.
struct RoughBoundary {
  Matrix reflection_above, transmission_down;  ///< of light from above
  Matrix reflection_below, transmission_up;    ///< of light from below
};

/// How wrong totals can be for the lattice of facets alone; 5e-5 is the worst met.
inline constexpr double rough_boundary_error = 1e-4;

/// Whether the boundary scatters at all; else it is treated as smooth, as RoughInterface has it.
[[nodiscard]] bool is_rough(const Interface& boundary, double ior_above, double ior_below);

/// Reflection and transmission by facets at independent heights, with all the light that meets
/// several of them: the same walk that photons take, as an equation of transfer between facets.
/// Nothing is lost: in mode 0 what leaves equals what arrives to rounding.
///
/// Heights are Gauss nodes in u, the fraction of lower facets. Directions are the nodes of the
/// grid, up and down.
///
/// @return  for `count` azimuthal modes from `first` on, [mode]; one after the other costs more.
/// @throws Interrupted if progress asks to stop.
///
/// Source: [Heitz2016] for the walk; its solution on a grid is lamina's (docs/adding_doubling.md).
[[nodiscard]] std::vector<RoughBoundary> rough_boundary_modes(const DirectionGrid& grid,
                                                              const Interface& boundary,
                                                              double ior_above, double ior_below,
                                                              int first, int count,
                                                              const Progress& progress = {});

}  // namespace lamina::detail
