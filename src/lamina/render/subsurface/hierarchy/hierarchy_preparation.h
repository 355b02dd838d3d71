// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/core/progress.h"
#include "lamina/render/geometry/camera_rays.h"
#include "lamina/render/subsurface/hierarchy/hierarchy_transport.h"
#include "lamina/render/subsurface/seen_surface.h"
#include "lamina/scene/render_options.h"

namespace lamina {

/// How the light on a material is sampled.
struct LightSampling {
  SpacingField field;
  int estimates = 32;  ///< of the light at each sample
  double cells = 0.0;  ///< samples, about: all, and close ones
  double close_cells = 0.0;
};

/// As close, and with as many estimates, as the picture can show: pixels, samples of a pixel, and
/// what of the surface is seen at all. Where the settings state the spacing, ask for refinement, or
/// samples are kept for other cameras, the surface is sampled evenly.
template <int N>
[[nodiscard]] LightSampling plan_sampling(const HierarchyTransport<N>& hierarchy,
                                          const RenderScene& scene, const CameraRays& camera,
                                          const SeenSurface& seen, const RenderOptions& options);

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
                                       const SeenSurface& seen, const LightGatherer<N>& light,
                                       const RenderOptions& options, const Progress& progress,
                                       std::vector<LightSamples>& sampled);

}  // namespace lamina
