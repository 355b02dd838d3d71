// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "lamina/solve/scattering/spatial_frequency/internal/frequency_states.h"
#include "lamina/solve/scattering/spatial_frequency/internal/stack_at_frequency.h"

namespace lamina::reference {

/// Reflection of the whole stack between the states outside above: the spectral BSSRDF on the grid
/// and its beams. Columns hold flux over the square root of the node's etendue, in which
/// reciprocity makes the matrix symmetric up to the sign of the odd modes.
struct SpectralReflection {
  detail::Matrix matrix;
  std::vector<int> mode;          ///< [state]
  std::vector<std::size_t> node;  ///< [state]
};
inline SpectralReflection spectral_reflection(const detail::FrequencySolver& solver, double k) {
  detail::FrequencyStates states = detail::make_states(solver, solver.stack.ior.front());
  return {detail::stacks_at(solver, {&k, 1}).front().reflection, std::move(states.mode),
          std::move(states.node)};
}

}  // namespace lamina::reference
