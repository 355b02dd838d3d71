// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_solver.h"

namespace lamina::detail {

/// The whole stack at one spatial frequency.
struct StackAtFrequency {
  std::vector<Crossing> crossings;  ///< bottom first
  Matrix reflection;                ///< of the whole, for light from above
};

/// [frequency]
[[nodiscard]] std::vector<StackAtFrequency> stacks_at(const FrequencySolver& solver,
                                                      std::span<const double> frequencies);

[[nodiscard]] Covered cover_by_interface(const FrequencySolver& solver, std::size_t index,
                                         Matrix below);

/// Reflection of the ground, in mode 0.
[[nodiscard]] Matrix ground_reflection(const FrequencySolver& solver);

}  // namespace lamina::detail
