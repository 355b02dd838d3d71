// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lamina/render/geometry/camera_rays.h"
#include "lamina/scene/description/scene.h"

namespace lamina {

/// Smallest width of a pixel on a material [mm]; 0 if none sees it.
[[nodiscard]] float nearest_pixel(const Scene& scene, const CameraRays& camera,
                                  std::uint32_t material);

}  // namespace lamina
