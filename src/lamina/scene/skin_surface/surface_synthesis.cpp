// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "lamina/base/core/hash.h"
#include "lamina/base/core/random.h"
#include "lamina/scene/skin_surface/internal/surface_canvas.h"
#include "lamina/scene/surface/point_grid.h"

namespace lamina {
namespace {

/// What faces away by more counts as another part of the surface.
constexpr float least_facing = 0.5f;

/// Middles of tiles: texels no closer to each other than a tile unless they face another way, and
/// so many that every texel is as close to one. Texels are asked in an order that the seed
/// shuffles.
std::vector<PointGrid::Place> scatter_tiles(const SurfaceCanvas& canvas, float spacing,
                                            std::uint64_t seed) {
  std::vector<std::uint32_t> order(canvas.texels.size());
  std::iota(order.begin(), order.end(), 0u);
  Random random = make_random(seed, 0);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.bits() % i]);
  const auto cube_of = [&](float x) { return static_cast<std::int64_t>(std::floor(x / spacing)); };
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cubes;
  std::vector<PointGrid::Place> tiles;
  for (const std::uint32_t i : order) {
    const SurfaceTexel& texel = canvas.texels[i];
    const std::int64_t x = cube_of(texel.position.x), y = cube_of(texel.position.y),
                       z = cube_of(texel.position.z);
    const auto is_covered_from = [&](std::int64_t dx, std::int64_t dy, std::int64_t dz) {
      const auto cube = cubes.find(cell_key(x + dx, y + dy, z + dz));
      return cube != cubes.end() && std::ranges::any_of(cube->second, [&](std::uint32_t t) {
               return length(tiles[t].position - texel.position) < spacing &&
                      dot(tiles[t].normal, texel.normal) > least_facing;
             });
    };
    bool is_covered = false;
    for (std::int64_t n = 0; n < 27 && !is_covered; ++n)
      is_covered = is_covered_from(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    if (is_covered) continue;
    cubes[cell_key(x, y, z)].push_back(static_cast<std::uint32_t>(tiles.size()));
    tiles.push_back({texel.position, texel.normal});
  }
  return tiles;
}

}  // namespace

void apply_feature(const Synthesis& synthesis, const SurfacePlaces& where, std::uint64_t seed,
                   SurfaceCanvas& canvas) {
  const MapExample& example = synthesis.example;
  const auto spacing = static_cast<float>(example.tile());
  const std::vector<PointGrid::Place> middles = scatter_tiles(canvas, spacing, seed);
  std::vector<Framef> frames;
  std::vector<MapExample::Shift> shifts;
  for (const PointGrid::Place& middle : middles) {
    shifts.push_back(example.shift_of(seed, frames.size()));
    frames.push_back(upright_frame(middle.normal));
  }
  // One tile is nearer than `spacing` and counts as at most twice as far, for it may face aside.
  const PointGrid grid(middles, 2.0f * spacing + static_cast<float>(example.reach()));
  for_texels(canvas, [&](std::size_t i) {
    const SurfaceTexel& texel = canvas.texels[i];
    const float weight = where.weight(texel.position);
    if (!(weight > 0.0f)) return;
    const PointGrid::Near near = grid.near(texel.position, texel.normal);
    std::array<MapExample::Tile, PointGrid::capacity> tiles;
    for (std::size_t k = 0; k < near.count; ++k) {
      const std::uint32_t tile = near.point[k];
      const Vec2f offset = unrolled(frames[tile], -near.offset[k]);
      tiles[k] = {MapExample::place_of(shifts[tile], {offset.x, offset.y}),
                  static_cast<double>(std::hypot(offset.x, offset.y) *
                                      (1.0f + 2.0f * (1.0f - near.facing[k])))};
    }
    if (near.count == 0) return;
    std::array<double, MapExample::most_maps> store;
    const std::span<double> values(store.data(), example.maps().size());
    example.values_at(std::span(tiles).first(near.count), static_cast<double>(texel.width), values);
    change_by_synthesis(canvas.skin[i], synthesis, values, static_cast<double>(weight));
  });
}

}  // namespace lamina
