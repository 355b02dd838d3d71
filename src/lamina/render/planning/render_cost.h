// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/render/paths/path_tracer.h"
#include "lamina/render/subsurface/preparation.h"
#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {

/// About how long the picture will take [CPU s], by what its methods say, or by a few of its paths,
/// which are timed, and the number of all. If it may end at a noise to reach, the most that it may
/// take. Within a factor of 3 (test).
///
/// @param methods  of the picture, not prepared
/// @param share    of the picture's pixels that are rendered
template <int N>
[[nodiscard]] double expected_cpu_seconds(const SubsurfaceMethods<N>& methods,
                                          const Preparation<N>& with, const PathTracer<N>& tracer,
                                          double share = 1.0);

}  // namespace lamina
