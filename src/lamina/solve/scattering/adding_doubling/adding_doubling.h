// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_totals.h"

namespace lamina {

struct AddingDoublingOptions {
  double accuracy = 1e-5;  ///< asked of each total, absolute; down to 1e-10
  int max_nodes = 96;      ///< of the direction grid's first segment, >= 4; where refining stops
  Progress progress = {};  ///< told that the work goes on, not how far it is
};

/// Solves the equation of radiative transfer in a layer stack; no diffusion, no noise.
///
/// Every layer has its own index, so light is refracted and totally reflected inside the stack.
/// A grid of directions is refined until the totals stay. Error: below the one asked for, with the
/// estimate on the safe side; rounding stands at 1e-11. Rough boundaries, with all light that meets
/// several of their facets, are good to 1e-4 and cost 0.1 s or so each.
///
/// In a semi-infinite stack `transmittance` is 0, unless its last layer is clear: then it is the
/// light that goes down and never returns. Over a ground that reflects it is what the ground takes.
///
/// @throws Interrupted if progress asks to stop.
///
/// Source: [Plass1973], [Wiscombe1977], [Prahl1993]; the grid that has one index per layer and the
/// doubling by even and odd illumination are lamina's (docs/adding_doubling.md).
[[nodiscard]] AddingDoublingTotals adding_doubling(const LayerStack& stack,
                                                   Incidence incidence = {},
                                                   const AddingDoublingOptions& options = {});

/// Totals of several directions at once: one solution serves them all.
[[nodiscard]] std::vector<AddingDoublingTotals> adding_doubling_by_angle(
    const LayerStack& stack, std::span<const Incidence> incidences,
    const AddingDoublingOptions& options = {});

/// Totals on one grid of directions, which is not refined: a smooth function of what the layers
/// are made of, as fits need it, where refined ones jump from grid to grid. No error is estimated.
///
/// @param nodes  of the grid's first segment, >= 4.
[[nodiscard]] AddingDoublingTotals adding_doubling_on_grid(const LayerStack& stack,
                                                           Incidence incidence, int nodes);

/// Totals of all bands of a material, in parallel.
[[nodiscard]] std::vector<AddingDoublingTotals> adding_doubling(
    std::span<const LayerStack> bands, Incidence incidence = {},
    const AddingDoublingOptions& options = {});

}  // namespace lamina
