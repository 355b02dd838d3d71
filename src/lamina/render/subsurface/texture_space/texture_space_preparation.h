// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/core/progress.h"
#include "lamina/render/geometry/camera_rays.h"
#include "lamina/render/subsurface/texture_space/texture_space_transport.h"
#include "lamina/scene/render_options.h"

namespace lamina {

/// Samples the light on the surfaces of all materials in texture space and lets it spread.
///
/// @param options  of these the cache, of what leaves: kept light serves until a pixel sees half a
///                 texel. Without one, what this camera does not see is sampled sparingly.
/// @return         whether it was completed
/// @throws         as find_kept_light, keep_light, TextureSpaceTransport
template <int N>
[[nodiscard]] bool prepare_texture_spaces(const std::vector<TextureSpaceTransport<N>*>& transports,
                                          const RenderScene& scene, const CameraRays& camera,
                                          const LightGatherer<N>& light,
                                          const RenderOptions& options, const Progress& progress);

}  // namespace lamina
