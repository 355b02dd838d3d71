// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/scattering/adding_doubling_stack.h"

namespace lamina::detail {

/// Light of a normal pencil beam that is scattered once and leaves without a further reflection, at
/// distance r [mm] from the beam [1/mm²]. The beam itself has all its reflections.
///
/// The forward peak that the grid takes for no scattering weakens nothing here either, but the
/// angles are those of the whole phase function.
struct SingleScatteringProfile {
  double reflectance = 0.0, transmittance = 0.0;
};

/// @param on_grid  the same stack on a grid with the beam as its first extra node.
/// @param r        [mm], > 0.
[[nodiscard]] SingleScatteringProfile single_scattering_profile(const LayerStack& stack,
                                                                const GridStack& on_grid, double r);

}  // namespace lamina::detail
