// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lamina/scene/description/scene.h"
#include "lamina/scene/surface/surface_point.h"

namespace lamina {

/// Selects at most so many of points in any order, spread over them: always the same ones.
[[nodiscard]] std::vector<SurfacePoint> some_of(const std::vector<SurfacePoint>& all,
                                                std::size_t most);

/// About so many points, evenly over the surface of a material.
[[nodiscard]] std::vector<SurfacePoint> points_all_over(const Scene& scene, std::uint32_t material,
                                                        std::size_t count);

}  // namespace lamina
