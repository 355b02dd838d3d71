// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lamina/scene/description/scene.h"

namespace lamina {

/// Whether any triangle has a material, [material]; all are where there are no meshes. Others are
/// read, so that what is wrong with
/// them is said, but nothing is prepared for them, and they ask for no method and no bands.
[[nodiscard]] std::vector<bool> materials_in_use(const Scene& scene);

/// Materials in use that are SubsurfaceSurface, indices into Scene::materials.
[[nodiscard]] std::vector<std::uint32_t> translucent_materials_in_use(const Scene& scene);

}  // namespace lamina
