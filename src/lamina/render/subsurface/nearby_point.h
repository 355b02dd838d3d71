// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lamina/render/shading/render_scene.h"
#include "lamina/scene/surface/surface_point.h"

namespace lamina {

/// The point of a material's surface over or under a place in the tangent plane of another point:
/// of those that face the same way the nearest to the plane; the point itself if there is none.
///
/// @param offset  of the place, along two axes of the plane [mm]
/// @param reach   how far from the plane it may lie [mm]
[[nodiscard]] SurfacePoint nearby_point(const RenderScene& scene, std::uint32_t material,
                                        const SurfacePoint& point, Vec2f offset, float reach);

}  // namespace lamina
