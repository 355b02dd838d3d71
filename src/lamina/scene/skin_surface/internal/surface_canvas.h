// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lamina/base/core/parallel.h"
#include "lamina/base/core/vec.h"
#include "lamina/scene/skin_surface/surface_skin_maps.h"

namespace lamina {

/// A texel of the maps that lies on the surface.
struct SurfaceTexel {
  std::size_t pixel;
  Vec3f position, normal;
  Vec2f uv;
  float width;  ///< on the surface, where it is widest [mm]
};

/// The skin of each texel while features change it.
struct SurfaceCanvas {
  const SurfaceMapRecipe& recipe;
  std::vector<SurfaceTexel> texels;
  std::vector<SkinParameters> skin;
  std::vector<ColorMatch> matches;
};

/// Calls `act(i)` for all texels, on all threads.
template <class Act>
void for_texels(const SurfaceCanvas& canvas, const Act& act) {
  constexpr std::size_t chunk = 4096;
  parallel_for((canvas.texels.size() + chunk - 1) / chunk, [&](std::size_t c) {
    for (std::size_t i = c * chunk; i < std::min(canvas.texels.size(), (c + 1) * chunk); ++i)
      act(i);
  });
}

/// Axes on a surface around a point of it: z is its normal, y points as far up (+y of the mesh) as
/// the surface lets it, and on level ground towards +z.
[[nodiscard]] Framef upright_frame(const Vec3f& normal);

/// Where a point lies on the paper that touches the surface at the frame's origin and is rolled
/// along it: as far away as it is in space, in the direction in which it is seen from above.
[[nodiscard]] Vec2f unrolled(const Framef& frame, const Vec3f& offset);

/// The texel nearest to a place. @throws InvalidInput if that is further away than `most` [mm].
[[nodiscard]] const SurfaceTexel& nearest_texel(const SurfaceCanvas& canvas, const Vec3f& at,
                                                float most);

// Features that surface_skin_maps.cpp has no room for.
void apply_feature(const Synthesis&, const SurfacePlaces&, std::uint64_t seed, SurfaceCanvas&);
void apply_feature(const SurfaceTattoo&, const SurfacePlaces&, std::uint64_t seed, SurfaceCanvas&);
void apply_feature(const SurfacePress&, const SurfacePlaces&, std::uint64_t seed, SurfaceCanvas&);
void apply_feature(const SurfaceVein&, const SurfacePlaces&, std::uint64_t seed, SurfaceCanvas&);

}  // namespace lamina
