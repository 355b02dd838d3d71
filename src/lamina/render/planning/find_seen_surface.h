// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/render/geometry/camera_rays.h"
#include "lamina/render/paths/path.h"
#include "lamina/render/subsurface/seen_surface.h"

namespace lamina {

/// Sends rays from the camera and times a few of them.
template <int N>
[[nodiscard]] SeenSurface find_seen_surface(const RenderScene& scene,
                                            const BandConversion<N>& conversion,
                                            const ThinSheets<N>& sheets,
                                            const Coverings<N>& coverings,
                                            const CameraRays& camera);

}  // namespace lamina
