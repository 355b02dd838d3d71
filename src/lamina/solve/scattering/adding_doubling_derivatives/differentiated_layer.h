// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/solve/scattering/adding_doubling/adding_doubling_layer.h"

namespace lamina::detail {

/// Reflection and transmission of a layer with their derivatives.
struct DifferentiatedLayer {
  LayerOperators operators;
  LayerOperators by_sigma_a, by_sigma_s, by_g, by_thickness;
};

/// One more thin slice at the bottom: dR/dd = T B T, dT/dd = (A + R B) T.
///
/// @param A, B  of the layer's equation dF+/dz = A F+ + B F-.
///
/// Source: [Chandrasekhar1960] §52, in matrices.
[[nodiscard]] LayerOperators by_thickness(const LayerOperators& layer, const Matrix& A,
                                          const Matrix& B);

/// Differentiates, for azimuthal mode 0, what `layer_operators` does on this grid: what delta-M
/// takes out and what goes straight on for the sake of energy change with g, the thickness of the
/// thin start with that of the layer. In a layer that does not scatter, `by_sigma_s` is that of its
/// first scattering.
///
/// @param on_grid  made from `layer` on this grid.
[[nodiscard]] DifferentiatedLayer differentiate_layer(const Layer& layer, const GridLayer& on_grid,
                                                      const DirectionGrid& grid);

}  // namespace lamina::detail
