// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/differentiated_solver.h"

#include <cstddef>
#include <utility>

namespace lamina::detail {

DifferentiatedSolver differentiate_solver(const LayerStack& stack, FrequencySolver solver) {
  DifferentiatedSolver made{.solver = std::move(solver)};
  const GridStack& on_grid = made.solver.stack;
  for (std::size_t l = 0; l < on_grid.layers.size(); ++l) {
    const GridLayer& layer = on_grid.layers[l];
    const auto in_all_modes = [&](GridLayerDerivative derivative) {
      ScatteringDerivative all{std::move(derivative), {}};
      for (int m = 0; m <= made.solver.modes; ++m)
        all.phase.push_back(phase_mode(all.on_grid.moments, layer.cos, m));
      return all;
    };
    GridLayerDerivatives of_layer = grid_layer_derivatives(stack.layers()[l], layer, on_grid.grid);
    made.by_sigma_a.push_back(in_all_modes(std::move(of_layer.by_sigma_a)));
    made.by_sigma_s.push_back(in_all_modes(std::move(of_layer.by_sigma_s)));
    made.by_g.push_back(in_all_modes(std::move(of_layer.by_g)));
  }
  return made;
}

}  // namespace lamina::detail
