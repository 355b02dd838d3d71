// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lamina/core/progress.h"
#include "lamina/render/geometry/camera_rays.h"
#include "lamina/render/paths/path_tracer.h"
#include "lamina/render/subsurface/seen_surface.h"
#include "lamina/scene/render_options.h"
#include "lamina/scene/scene.h"

namespace lamina {

/// The method for a scene that leaves it open: what its materials need, else what its settings are
/// of, else what costs less, by the number of paths. The same scene always gets the same one.
struct MethodChoice {
  SceneMethod method;
  std::string why;  ///< a phrase
};
template <int N>
[[nodiscard]] MethodChoice choose_method(const RenderScene& scene,
                                         const BandConversion<N>& conversion,
                                         const CameraRays& camera, const SeenSurface& seen,
                                         const RenderOptions& options,
                                         const Progress& progress = {});

}  // namespace lamina
