// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/grid_layer_derivatives.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_solver.h"

namespace lamina::detail {

/// A parameter of a layer, in all azimuthal modes.
struct ScatteringDerivative {
  GridLayerDerivative on_grid;
  std::vector<PhaseMode> phase;  ///< [mode] of on_grid.moments
};

/// A solver with what its derivatives take and does not depend on frequency.
struct DifferentiatedSolver {
  FrequencySolver solver;
  std::vector<ScatteringDerivative> by_sigma_a, by_sigma_s, by_g;  ///< [layer]
};

/// @param stack  of which the solver is; its boundaries are smooth.
[[nodiscard]] DifferentiatedSolver differentiate_solver(const LayerStack& stack,
                                                        FrequencySolver solver);

}  // namespace lamina::detail
