// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "lamina/base/core/vec.h"
#include "lamina/scene/description/scene.h"
#include "lamina/scene/surface/surface_point.h"

namespace lamina {

/// A box along the axes [mm].
struct Box {
  Vec3f low, high;
};
/// Around all triangles of a material; both corners 0 if there are none.
[[nodiscard]] Box box_of_material(const Scene& scene, std::uint32_t material);

/// Around points, with a margin.
[[nodiscard]] Box box_around(std::span<const SurfacePoint> points, float margin);

/// Warning that names the mesh of the material that is open, where, and what to do; absent if all
/// are closed.
[[nodiscard]] std::optional<std::string> openness(const Scene& scene, std::uint32_t material);

}  // namespace lamina
