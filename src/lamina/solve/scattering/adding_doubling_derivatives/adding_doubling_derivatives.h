// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/layer_derivatives.h"

namespace lamina {

/// Totals and their derivatives. The specular reflectance depends on indices only.
struct AddingDoublingDerivatives {
  AddingDoublingTotals totals;                              ///< as adding_doubling gives them
  std::vector<LayerDerivatives> diffuse_reflectance;        ///< [layer]
  std::vector<LayerDerivatives> transmittance;              ///< [layer] unscattered light included
  std::vector<LayerDerivatives> unscattered_transmittance;  ///< [layer]
  std::vector<LayerDerivatives> unscattered_reflectance;    ///< [layer]
};

/// Solves a stack, and differentiates the solution on the last grid of directions exactly: to 1e-7
/// of central differences on that grid. All layers and parameters together take three to four times
/// as long as the totals.
///
/// In a layer that does not scatter, by_sigma_s is the derivative towards scattering; light that
/// its first scattering would catch between the boundaries counts as lost, which is so if the layer
/// absorbs.
///
/// @throws InvalidInput naming the layer, if a boundary is rough, or if an infinitely thick layer
///         absorbs nothing: there the derivative by sigma_a is infinite.
/// @throws Interrupted if progress asks to stop.
///
/// How: docs/adding_doubling.md.
[[nodiscard]] AddingDoublingDerivatives adding_doubling_derivatives(
    const LayerStack& stack, Incidence incidence = {}, const AddingDoublingOptions& options = {});

/// Derivatives on one grid of directions, which is not refined: totals are those of
/// adding_doubling_on_grid, and the derivatives are theirs.
///
/// @param nodes  of the grid's first segment, >= 4.
[[nodiscard]] AddingDoublingDerivatives adding_doubling_derivatives_on_grid(const LayerStack& stack,
                                                                            Incidence incidence,
                                                                            int nodes);

/// Derivatives for several directions at once, [incidence].
[[nodiscard]] std::vector<AddingDoublingDerivatives> adding_doubling_derivatives_by_angle(
    const LayerStack& stack, std::span<const Incidence> incidences,
    const AddingDoublingOptions& options = {});

}  // namespace lamina
