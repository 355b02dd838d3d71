// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/differentiated_layer.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/layer_derivatives.h"

namespace lamina::detail {

/// Flux over the square root of etendue, [state].
using LightState = std::vector<double>;

/// Light behind each crossing: going down and up; or what a total gains by light that starts there.
struct LightFields {
  std::vector<LightState> down, up;  ///< [crossing]
};

/// A stack whose boundaries are smooth, as adding made it.
struct CrossedStack {
  std::span<const Crossing> crossings;      ///< top surface, first layer, second surface, ...
  std::span<const Matrix> from_below = {};  ///< [crossing] what it alone sends back of light from
                                            ///< below; wanted for transmittances
  /// [crossing] Signs of the states behind it, but for which reciprocity makes the operators
  /// symmetric (SlabProblem); no signs at all are +1.
  std::span<const LightState> signs = {};
};

/// Light fields inside, of light that arrives from above.
[[nodiscard]] LightFields fields_of(const CrossedStack& stack, LightState down);

/// Gains of light that starts behind a crossing, for what leaves above.
///
/// @param weights  of the states above, which have sign +1 where it is not 0.
[[nodiscard]] LightFields gains_above(const CrossedStack& stack, const LightState& weights);

/// Gains for what leaves below, whose states have these weights.
[[nodiscard]] LightFields gains_below(const CrossedStack& stack, const LightState& weights);

/// Derivatives of a total, from the light inside and what it gains by it.
[[nodiscard]] std::vector<LayerDerivatives> derivatives_of(
    std::span<const DifferentiatedLayer> layers, const LightFields& light,
    const LightFields& gains);

}  // namespace lamina::detail
