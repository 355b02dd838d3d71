// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "lamina/core/progress.h"
#include "lamina/render/camera_rays.h"
#include "lamina/render/hierarchy_transport.h"
#include "lamina/render/render.h"

namespace lamina {

/// Samples the light on the surfaces of all hierarchies and makes them ready. Where the settings
/// ask for it samples are made twice as close, from four times as far apart, until the light that
/// leaves hardly changes.
///
/// @param cache    a file that keeps the samples: read if it is there, else written. Empty: none.
///                 Samples that are kept are up to twice as close as this camera needs.
/// @param sampled  gets what was done, an entry per hierarchy
/// @return         whether it was completed
/// @throws       as load_irradiance_clouds, save_irradiance_clouds
template <int N>
[[nodiscard]] bool prepare_hierarchies(const std::vector<HierarchyTransport<N>*>& hierarchies,
                                       const RenderScene& scene, const CameraRays& camera,
                                       const LightGatherer<N>& light,
                                       const std::filesystem::path& cache, const Progress& progress,
                                       std::vector<LightSamples>& sampled);

}  // namespace lamina
