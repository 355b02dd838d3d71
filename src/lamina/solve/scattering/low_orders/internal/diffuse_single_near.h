// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/low_orders/single_scattering_profile.h"
#include "lamina/solve/scattering/spatial_frequency/top_passage.h"

namespace lamina::detail {

/// Profile of diffuse light from above on one point that is scattered once and neither before nor
/// after reflected, at distance r [mm] > 0 from that point [1/mm²]: ray by ray. Slow: near the
/// point, where it grows as 1/r, nothing else will do.
///
/// @param on_grid  the same stack on any grid.
/// @param top      of a solver of the stack.
[[nodiscard]] SingleScatteringProfile diffuse_single_profile(const LayerStack& stack,
                                                             const GridStack& on_grid,
                                                             const TopPassage& top, double r);

/// Limit of 2 pi r times that reflectance at r = 0 [1/mm], of a beam that a rough top spreads,
/// too, if `top` is of one: an integral over directions alone, which no extinction changes.
[[nodiscard]] double single_at_contact(const LayerStack& stack, const GridStack& on_grid,
                                       const TopPassage& top);

}  // namespace lamina::detail
