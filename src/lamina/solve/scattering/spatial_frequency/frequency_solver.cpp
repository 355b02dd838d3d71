// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/frequency_solver.h"

#include "lamina/solve/scattering/adding_doubling/kept_rough_boundaries.h"

namespace lamina::detail {

FrequencySolver make_frequency_solver(const LayerStack& stack, int nodes, int modes,
                                      std::span<const GridDirection> oblique,
                                      Illumination illumination, RoughModes rough) {
  std::vector<GridDirection> beams{direction_in(stack.ior_above(), 0.0)};
  beams.insert(beams.end(), oblique.begin(), oblique.end());
  // Light of an oblique beam that is scattered once is known by azimuths, as a chain cut off is.
  const AzimuthEnd end = oblique.empty() ? AzimuthEnd::absorbing : AzimuthEnd::cut_off;
  FrequencySolver solver{.stack = make_grid_stack(stack, nodes, beams),
                         .modes = modes,
                         .azimuth = make_azimuth_chain(modes, end)};
  solver.waves = azimuth_waves(solver.azimuth);
  for (const GridLayer& layer : solver.stack.layers) {
    auto& kernels = solver.phase.emplace_back();
    for (int m = 0; m <= modes; ++m) kernels.push_back(phase_mode(layer.moments, layer.cos, m));
  }
  solver.rough = kept_rough_boundaries(solver.stack, rough == RoughModes::first ? 1 : modes + 1);
  solver.top = make_top_passage(solver.stack, solver.rough[0], illumination);
  return solver;
}

}  // namespace lamina::detail
