// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/progress.h"
#include "lamina/render/film/render_options.h"
#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {

/// Makes the scene's method for all its materials, with what goes with it: colors that scale what
/// leaves, corrected light, and light scattered once. Empty entries for a method that is a BSDF.
///
/// @throws InvalidInput if light scattered once would count twice, and as the methods do.
template <int N>
[[nodiscard]] SubsurfaceMethods<N> make_subsurface_methods(const RenderScene& scene,
                                                           const BandConversion<N>& conversion,
                                                           const RenderOptions& options,
                                                           const Progress& progress);

}  // namespace lamina
