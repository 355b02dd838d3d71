// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/skin/acquire/inversion/internal/inversion_course.h"

namespace lamina::detail {

/// Steps by gradients and what the last ones tell of curvature (L-BFGS), from the best state of a
/// course on; BandBlocks stand for the curvature before the first step.
/// Source: [NocedalWright2006] Algorithm 7.5.
void run_lbfgs(PatchObjective& objective, const TexelMaps& level, InversionCourse& course,
               int most_steps);

/// Steps down a gradient that is estimated by moving each number at all texels at once, as
/// [Donner2008] §6 does: each texel takes the change of its own light alone. In shares of the
/// values of the reference skin.
void run_gradient_descent(const PatchObjective& objective, InversionCourse& course);

}  // namespace lamina::detail
