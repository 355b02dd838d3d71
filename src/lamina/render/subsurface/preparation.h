// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "lamina/base/core/progress.h"
#include "lamina/render/geometry/camera_rays.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/light_cache.h"
#include "lamina/render/subsurface/preparation_report.h"
#include "lamina/render/subsurface/seen_surface.h"
#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {

/// Inputs of a method's preparation for a picture.
template <int N>
struct Preparation {
  const RenderScene& scene;
  const LightGatherer<N>& light;
  const CameraRays& camera;
  const SeenSurface& seen;
  LightCache& cache;
  const Progress& progress;
  PreparationReport& report;
  /// Told of time that expected_cost() did not foresee, which may be negative [CPU s]. May be empty.
  std::function<void(double seconds)> on_more_work = {};
};

}  // namespace lamina
