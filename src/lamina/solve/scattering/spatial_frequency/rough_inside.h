// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_solver.h"

namespace lamina::detail {

/// Whether a boundary below the top is rough.
[[nodiscard]] bool has_rough_inside(const GridStack& stack);

/// Stack that light of the lowest orders sees, which is of them as long as it has met no facets
/// inside: the layers down to the first rough boundary below the top, over darkness of their own
/// index. Nothing leaves below. A stack without rough boundaries there is kept as it is.
[[nodiscard]] GridStack above_rough_inside(GridStack stack);

/// Transmittance of a rough last boundary for a normal beam under a smooth top, where the beam
/// arrives unscattered: light of all directions at r = 0, the same at every frequency. 0 in other
/// stacks.
///
/// @param which  extinction of the beam.
[[nodiscard]] double through_rough_bottom(const FrequencySolver& solver, Unscattered which);

}  // namespace lamina::detail
