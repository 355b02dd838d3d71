// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "lamina/core/progress.h"
#include "lamina/render/camera_rays.h"
#include "lamina/render/texture_space_transport.h"

namespace lamina {

/// Samples the light on the surfaces of all materials in texture space and lets it spread.
///
/// @param cache  a file that keeps what leaves: read if it is there, else written. Empty: none, and
///               what this camera does not see is sampled sparingly.
/// @return       whether it was completed
/// @throws       as load_irradiance_clouds, save_irradiance_clouds, TextureSpaceTransport
template <int N>
[[nodiscard]] bool prepare_texture_spaces(const std::vector<TextureSpaceTransport<N>*>& transports,
                                          const RenderScene& scene, const CameraRays& camera,
                                          const LightGatherer<N>& light,
                                          const std::filesystem::path& cache,
                                          const Progress& progress);

}  // namespace lamina
