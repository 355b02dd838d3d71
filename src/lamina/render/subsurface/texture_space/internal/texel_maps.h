// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/render/subsurface/texture_space/internal/texture_atlas.h"
#include "lamina/skin/maps/material_maps.h"
#include "lamina/skin/patch/material_texels.h"

namespace lamina {

/// Each map, of whatever size, as the mean over each texel of a surface; maps repeat beyond the
/// unit square.
[[nodiscard]] std::vector<NumberTexels> sample_maps(std::span<const MaterialMap> maps,
                                                    const std::vector<Mesh>& meshes,
                                                    const TextureAtlas& atlas);

/// Change of the barycentric weights for a step on the grid of a texel's chart, in texels.
[[nodiscard]] Vec2f barycentric_step(const std::vector<Mesh>& meshes, const AtlasTexel& texel,
                                     Vec2f step);

}  // namespace lamina
