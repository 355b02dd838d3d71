// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/texture_space/internal/far_sides.h"

#include "lamina/base/core/parallel_chunks.h"

namespace lamina {

std::vector<FarSide> find_far_sides(const RenderScene& scene, const TextureAtlas& atlas,
                                    std::uint32_t material, const std::vector<bool>& is_sheet,
                                    float reach) {
  const auto texels = atlas.texels();
  std::vector<FarSide> far_sides(texels.size());
  constexpr std::size_t chunk = 1024;
  parallel_chunks(texels.size(), chunk, [&](std::size_t i) {
    const AtlasTexel& texel = texels[i];
    if (is_sheet[texel.mesh]) return;
    ProbeHits found;
    scene.geometry.all_hits({texel.position, -texel.normal}, reach, material, found);
    float nearest = reach;
    for (const Hit& hit : found.all()) {
      if (hit.mesh != texel.mesh || hit.distance >= nearest) continue;
      const SurfacePoint point = make_surface_point(scene.scene->meshes, hit, 0.0f);
      const float facing = dot(point.geometric_normal, texel.normal);
      if (!(facing < 0.0f)) continue;  // the texel's own face, or an inner one
      nearest = hit.distance;
      far_sides[i] = {atlas.weights_at(point), 0.5f * (1.0f - facing)};
    }
  });
  return far_sides;
}

float share_without_far_side(const TextureAtlas& atlas, const std::vector<FarSide>& far_sides,
                             const std::vector<bool>& is_sheet) {
  float all = 0.0f, without = 0.0f;
  for (std::size_t i = 0; i < far_sides.size(); ++i) {
    const AtlasTexel& texel = atlas.texels()[i];
    if (is_sheet[texel.mesh]) continue;
    all += texel.area;
    if (!(far_sides[i].facing > 0.0f)) without += texel.area;
  }
  return all > 0.0f ? without / all : 0.0f;
}

}  // namespace lamina
