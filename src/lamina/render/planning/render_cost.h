// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/render/paths/path_tracer.h"
#include "lamina/render/subsurface/hierarchy/hierarchy_preparation.h"
#include "lamina/render/subsurface/shadow_map/shadow_map_transport.h"
#include "lamina/render/subsurface/texture_space/texture_space_transport.h"

namespace lamina {

/// What a picture is made with, once a method is chosen and nothing is prepared.
template <int N>
struct PictureWork {
  const RenderScene& scene;
  const CameraRays& camera;
  const PathTracer<N>& tracer;
  const SeenSurface& seen;
  const RenderOptions& options;
  // Of these methods, those that sample light first:
  const std::vector<HierarchyTransport<N>*>& hierarchies;
  const std::vector<TextureSpaceTransport<N>*>& texture_spaces;
  const std::vector<ShadowMapTransport<N>*>& shadow_maps;
  double lattices = 0.0;  ///< bodies whose light is looked at before random_walk
};

/// About how long the picture will take [CPU s], by a few of its paths, which are timed, and the
/// number of all. If it may end at a noise to reach, the most that it may take. Within a factor of
/// 3 (test).
template <int N>
[[nodiscard]] double expected_cpu_seconds(const PictureWork<N>& work);

}  // namespace lamina
