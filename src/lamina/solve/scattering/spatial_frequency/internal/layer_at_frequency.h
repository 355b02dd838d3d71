// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_layer.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/differentiated_layer.h"
#include "lamina/solve/scattering/spatial_frequency/differentiated_solver.h"
#include "lamina/solve/scattering/spatial_frequency/internal/frequency_states.h"

namespace lamina::detail {

/// A layer's equation at one frequency: dF+/dz = A F+ + B F-.
struct LayerEquation {
  Matrix A, B;
  double fastest = 0.0;  ///< [1/mm] at which the light of any state changes
};
[[nodiscard]] LayerEquation layer_equation(const FrequencySolver& solver, std::size_t index,
                                           const FrequencyStates& states, double k);

/// Reflection and transmission of a layer, [frequency].
[[nodiscard]] std::vector<LayerOperators> layer_at_frequencies(const FrequencySolver& solver,
                                                               std::size_t index,
                                                               std::span<const double> frequencies);

/// Operators of layers of 1, 2, 4, ... 2^(rungs - 1) times a thickness [mm] that are else as a
/// layer of the stack, [rung][frequency].
[[nodiscard]] std::vector<std::vector<LayerOperators>> layer_ladder_at_frequencies(
    const FrequencySolver& solver, std::size_t index, double thinnest, std::size_t rungs,
    std::span<const double> frequencies);

/// Layer at one frequency, with derivatives.
[[nodiscard]] DifferentiatedLayer differentiate_layer_at(const DifferentiatedSolver& differentiated,
                                                         std::size_t index, double k);

}  // namespace lamina::detail
