// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/single_correction.h"

#include <array>
#include <cstddef>

#include "lamina/solve/scattering/spatial_frequency/rough_inside.h"

namespace lamina::detail {
namespace {

constexpr int nodes_of_single = 32, modes_of_single = 21;

FrequencySolver solver_of_mode_0(const LayerStack& stack, int nodes, int modes) {
  FrequencySolver solver{.stack = above_rough_inside(make_grid_stack(
                             stack, nodes, std::array{direction_in(stack.ior_above(), 0.0)})),
                         .modes = modes,
                         .azimuth = make_azimuth_chain(modes)};
  solver.waves = azimuth_waves(solver.azimuth);
  for (const GridLayer& layer : solver.stack.layers)
    solver.phase.push_back({phase_mode(layer.moments, layer.cos, 0)});
  return solver;
}

}  // namespace

SingleCorrection::SingleCorrection(const LayerStack& stack, int nodes, int modes)
    : many_(solver_of_mode_0(stack, nodes_of_single, modes_of_single)),
      few_(solver_of_mode_0(stack, nodes, modes)) {
  // What the few directions take for unscattered goes on unscattered.
  for (std::size_t l = 0; l < many_.stack.layers.size(); ++l)
    many_.stack.layers[l].sigma_t = few_.stack.layers[l].sigma_t;
}

FrequencyResponse SingleCorrection::at(double k) const {
  const FrequencyResponse known = single_scattering_response(many_, k);
  const FrequencyResponse on_grid = single_scattering_response(few_, k);
  return {known.reflectance - on_grid.reflectance, known.transmittance - on_grid.transmittance};
}

}  // namespace lamina::detail
