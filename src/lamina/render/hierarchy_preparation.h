// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "lamina/core/progress.h"
#include "lamina/render/camera_rays.h"
#include "lamina/render/hierarchy_transport.h"

namespace lamina {

/// Samples the light on the surfaces of all hierarchies and makes them ready.
///
/// @param cache  a file that keeps the samples: read if it is there, else written. Empty: none.
///               Samples that are kept are up to twice as close as this camera needs.
/// @return       whether it was completed
/// @throws       as load_irradiance_clouds, save_irradiance_clouds
template <int N>
[[nodiscard]] bool prepare_hierarchies(const std::vector<HierarchyTransport<N>*>& hierarchies,
                                       const RenderScene& scene, const CameraRays& camera,
                                       const LightGatherer<N>& light,
                                       const std::filesystem::path& cache,
                                       const Progress& progress);

}  // namespace lamina
