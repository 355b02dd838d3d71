// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_layer.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_matrix.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_rough.h"
#include "lamina/solve/scattering/adding_doubling/direction_grid.h"

namespace lamina::detail {

/// A stack on a direction grid: what does not depend on the azimuthal mode.
struct GridStack {
  DirectionGrid grid;
  std::vector<double> ior;  ///< above, of each layer, below; nearly equal ones made equal
  std::vector<GridLayer> layers;
  std::vector<Interface> interfaces;  ///< [0] is the top surface, the last one the ground's
  double ground_reflectance = 0.0;
  bool is_semi_infinite = false;
};

/// @param nodes    of the first segment, >= 2.
/// @param extra  further directions, as in make_direction_grid.
[[nodiscard]] GridStack make_grid_stack(const LayerStack& stack, int nodes,
                                        std::span<const GridDirection> extra);

/// Indices above, of each layer and below. Those that differ by less than 1e-9 are made equal: so
/// thin a segment of directions holds no light that counts, but would need many doublings.
[[nodiscard]] std::vector<double> merged_indices(const LayerStack& stack);

/// Reflectance of a smooth interface at a node that both sides have.
[[nodiscard]] double node_fresnel(const DirectionGrid& grid, std::size_t node, double ior_a,
                                  double ior_b);

/// Reflection of a smooth interface to the side of the first index.
[[nodiscard]] Matrix mirror(const DirectionGrid& grid, double ior, double ior_beyond);

/// An interface or a layer lying on all that is below it.
struct Crossing {
  Matrix pass;              ///< flux down behind it per flux down before it, after all returns
  Matrix reflection_below;  ///< of what lies behind it
  Matrix returns = {};      ///< flux down behind it per flux that first gets there, if smooth
};

/// Covered layers, with the reflection of the whole that they make.
struct Covered {
  Crossing crossing;
  Matrix reflection;
};
[[nodiscard]] Covered cover_by_layer(const LayerOperators& layer, Matrix below);

/// How a stack reflects and where its light goes, for one azimuthal mode.
struct StackOperators {
  std::vector<Crossing> crossings;  ///< top surface, first layer, second surface, ...
  Matrix reflection;                ///< of the whole, for light from above
  Matrix first_reflection;          ///< of the top surface alone
};

/// The rough boundaries of a stack for one azimuthal mode, [interface]; smooth ones are empty. They
/// depend on the indices and interfaces alone: stacks with equal ones may share them.
using RoughBoundaries = std::vector<RoughBoundary>;

/// For `count` azimuthal modes from `first` on, [mode].
/// @throws Interrupted if progress asks to stop.
[[nodiscard]] std::vector<RoughBoundaries> rough_boundaries(const GridStack& stack, int first,
                                                            int count,
                                                            const Progress& progress = {});

/// Stacks whose rough boundaries are equal, by their places in `stacks`. A smooth stack stands
/// alone.
[[nodiscard]] std::vector<std::vector<std::size_t>> groups_of_equal_boundaries(
    std::span<const LayerStack> stacks);

/// Adds up the stack from the bottom.
///
/// @param rough  of this stack or of one with equal boundaries, for mode m.
///
/// Source: [Plass1973], with an interface as one more layer.
[[nodiscard]] StackOperators stack_operators(const GridStack& stack, int m,
                                             const RoughBoundaries& rough);

/// Operators of given layers, [layer].
[[nodiscard]] StackOperators stack_operators(const GridStack& stack, int m,
                                             const RoughBoundaries& rough,
                                             std::span<const LayerOperators> layers);

/// Operators of a stack that is used once.
[[nodiscard]] StackOperators stack_operators(const GridStack& stack, int m);

/// @throws InvalidInput naming the layer whose boundary is rough; `method` names who refuses.
void require_smooth(const LayerStack& stack, const std::string& method);

/// Stack seen from below: above and below exchanged. Not for half-spaces.
[[nodiscard]] GridStack turned_over(const GridStack& stack);

/// Extinction that weakens unscattered light.
enum class Unscattered {
  by_medium,  ///< the true one
  scaled,     ///< that of the operators, for which a forward peak is no scattering
  on_grid     ///< scaled, with what the quadrature adds to it
};

/// Light of one node that is reflected and refracted by the interfaces but not scattered, neither
/// inside nor by rough boundaries, for unit flux from above.
struct UnscatteredFlux {
  std::vector<double> down, up;  ///< [crossing] just behind it
  double reflectance = 0.0;      ///< of the whole stack
};
[[nodiscard]] UnscatteredFlux unscattered_flux(const GridStack& stack, std::size_t node,
                                               Unscattered which);

}  // namespace lamina::detail
