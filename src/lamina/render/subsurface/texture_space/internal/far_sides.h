// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/texture_space/internal/texture_atlas.h"

namespace lamina {

/// The place on the other side of a closed body where light leaves that has passed the layers.
struct FarSide {
  TextureAtlas::Weights place;
  float facing = 0.0f;  ///< share of the light that leaves there, by the normals; 0: there is none
};

/// The far sides of texels on closed meshes, [texel]: where the inward normal leaves the mesh, if
/// that is near.
///
/// @param is_sheet  [mesh] whose texels have none
/// @param reach     [mm]
[[nodiscard]] std::vector<FarSide> find_far_sides(const RenderScene& scene,
                                                  const TextureAtlas& atlas, std::uint32_t material,
                                                  const std::vector<bool>& is_sheet, float reach);

/// The share of the area of closed meshes that has no far side.
[[nodiscard]] float share_without_far_side(const TextureAtlas& atlas,
                                           const std::vector<FarSide>& far_sides,
                                           const std::vector<bool>& is_sheet);

}  // namespace lamina
