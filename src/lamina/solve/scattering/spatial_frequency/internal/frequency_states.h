// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lamina/solve/scattering/spatial_frequency/frequency_solver.h"

namespace lamina::detail {

/// The states of one medium: even modes first, as the slab's symmetry wants them.
struct FrequencyStates {
  std::vector<std::size_t> node;
  std::vector<int> mode;
  std::size_t even = 0;
  std::vector<std::size_t> offset;  ///< [mode] where it starts
  std::vector<std::size_t> local;   ///< [node] place within a mode other than 0

  [[nodiscard]] std::size_t size() const { return node.size(); }
};

/// In mode 0 all active nodes; in the others all but the beam, which has no azimuth.
[[nodiscard]] FrequencyStates make_states(const FrequencySolver& solver, double ior);

[[nodiscard]] std::size_t place(const FrequencyStates& states, int mode, std::size_t node);

}  // namespace lamina::detail
