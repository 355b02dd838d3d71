// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"

namespace lamina::detail {

/// `rough_boundaries` for the azimuthal modes 0 to `count` - 1, [mode]. Bands of a material and
/// slabs of many thicknesses ask for the same ones again and again, at a tenth of a second each, so
/// the last few are kept: they depend on nothing but directions, indices and interfaces.
/// @throws Interrupted if progress asks to stop.
[[nodiscard]] std::vector<RoughBoundaries> kept_rough_boundaries(const GridStack& stack, int count,
                                                                 const Progress& progress = {});

}  // namespace lamina::detail
