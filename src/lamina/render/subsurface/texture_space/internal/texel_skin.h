// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/render/subsurface/texture_space/internal/texture_atlas.h"
#include "lamina/scattering/heterogeneous/surface_transport.h"
#include "lamina/skin_maps/skin_maps.h"

namespace lamina {

/// The maps of skin at the texels of a surface.
struct TexelSkin {
  std::size_t texels = 0;
  std::vector<std::vector<float>> values;  ///< [map][texel]
};

/// Each map, of whatever size, as the mean over the texel; maps repeat beyond the unit square.
[[nodiscard]] TexelSkin sample_skin(std::span<const SkinMap> maps, const std::vector<Mesh>& meshes,
                                    const TextureAtlas& atlas);

/// What skin absorbs at each texel in one band. Maps replace what the recipe says.
[[nodiscard]] CellAbsorption absorption_of(SkinParameters skin, std::span<const SkinMap> maps,
                                           const TexelSkin& at_texels, double wavelength);

/// Change of the barycentric weights for a step on the grid of a texel's chart, in texels.
[[nodiscard]] Vec2f barycentric_step(const std::vector<Mesh>& meshes, const AtlasTexel& texel,
                                     Vec2f step);

}  // namespace lamina
