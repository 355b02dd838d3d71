// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/core/progress.h"
#include "lamina/render/camera_rays.h"
#include "lamina/render/hierarchy_transport.h"

namespace lamina {

/// Samples the light on the surfaces of all hierarchies and makes them ready.
///
/// @return whether it was completed
template <int N>
[[nodiscard]] bool prepare_hierarchies(const std::vector<HierarchyTransport<N>*>& hierarchies,
                                       const RenderScene& scene, const CameraRays& camera,
                                       const LightGatherer<N>& light, const Progress& progress);

}  // namespace lamina
