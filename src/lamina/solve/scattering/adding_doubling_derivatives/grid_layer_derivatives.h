// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_layer.h"

namespace lamina::detail {

/// How what a layer does to light on a grid changes with one parameter of its medium.
struct GridLayerDerivative {
  std::vector<double> moments;     ///< [l] of sigma_s times those of the truncated phase function
  std::vector<double> extinction;  ///< [node] of node_extinction
  double backward = 0.0;           ///< of the scattering straight back
};

/// Changes with g of what delta-M takes out, and of what goes straight on for the sake of energy.
struct GridLayerDerivatives {
  GridLayerDerivative by_sigma_a, by_sigma_s, by_g;
};

/// @param on_grid  made from `layer` on this grid.
[[nodiscard]] GridLayerDerivatives grid_layer_derivatives(const Layer& layer,
                                                          const GridLayer& on_grid,
                                                          const DirectionGrid& grid);

}  // namespace lamina::detail
