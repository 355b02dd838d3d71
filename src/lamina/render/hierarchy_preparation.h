// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

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
/// @param options  of these the cache. Samples that are kept are twice as close as this camera
///                 needs, so that others may come nearer; one that needs closer ones makes them.
/// @param sampled  gets what was done, an entry per hierarchy
/// @return         whether it was completed
/// @throws       as find_kept_light, keep_light
template <int N>
[[nodiscard]] bool prepare_hierarchies(const std::vector<HierarchyTransport<N>*>& hierarchies,
                                       const RenderScene& scene, const CameraRays& camera,
                                       const LightGatherer<N>& light, const RenderOptions& options,
                                       const Progress& progress,
                                       std::vector<LightSamples>& sampled);

}  // namespace lamina
