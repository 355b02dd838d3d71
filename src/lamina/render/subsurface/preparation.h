// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/render/geometry/camera_rays.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/light_cache.h"
#include "lamina/render/subsurface/seen_surface.h"
#include "lamina/render/subsurface/subsurface_method.h"
#include "lamina/scene/description/render_options.h"

namespace lamina {

/// Notes and costs of a method's preparation.
struct PreparationReport {
  std::vector<LightSamples> light_samples;
  std::vector<LightCorrection> corrections;
  std::vector<std::string> warnings;  ///< one line each
};

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
};

}  // namespace lamina
