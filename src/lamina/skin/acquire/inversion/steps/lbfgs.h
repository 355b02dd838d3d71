// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/skin/acquire/inversion/steps/inversion_course.h"

namespace lamina::detail {

/// Steps by gradients and what the last ones tell of curvature (L-BFGS), from the best state of a
/// course on; BandBlocks stand for the curvature before the first step.
/// Source: [NocedalWright2006] Algorithm 7.5.
void run_lbfgs(PatchObjective& objective, const TexelMaps& level, InversionCourse& course,
               int most_steps);

}  // namespace lamina::detail
