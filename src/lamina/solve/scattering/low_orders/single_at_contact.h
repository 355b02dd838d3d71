// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/low_orders/single_scattering_profile.h"
#include "lamina/solve/scattering/spatial_frequency/top_passage.h"

namespace lamina::detail {

/// Limit at r = 0 of 2 pi r times the reflectance [1/mm] of diffuse light from above on one point
/// that is scattered once and neither before nor after reflected; of a beam that a rough top
/// spreads, too, if `top` is of one: an integral over directions alone, which no extinction
/// changes.
[[nodiscard]] double single_at_contact(const LayerStack& stack, const GridStack& on_grid,
                                       const TopPassage& top);

}  // namespace lamina::detail
