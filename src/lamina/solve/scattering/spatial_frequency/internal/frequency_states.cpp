// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/internal/frequency_states.h"

namespace lamina::detail {

FrequencyStates make_states(const FrequencySolver& solver, double ior) {
  const std::size_t beam = solver.stack.grid.extra[0];
  const std::size_t active = active_count(solver.stack.grid, ior);
  FrequencyStates states;
  states.offset.resize(static_cast<std::size_t>(solver.modes) + 1);
  for (std::size_t i = 0; i < active; ++i) states.local.push_back(i < beam ? i : i - 1);
  for (const int parity : {0, 1}) {
    for (int m = parity; m <= solver.modes; m += 2) {
      states.offset[static_cast<std::size_t>(m)] = states.size();
      for (std::size_t i = 0; i < active; ++i) {
        if (m > 0 && i == beam) continue;
        states.node.push_back(i);
        states.mode.push_back(m);
      }
    }
    if (parity == 0) states.even = states.size();
  }
  return states;
}

std::size_t place(const FrequencyStates& states, int mode, std::size_t node) {
  return states.offset[static_cast<std::size_t>(mode)] + (mode == 0 ? node : states.local[node]);
}

}  // namespace lamina::detail
