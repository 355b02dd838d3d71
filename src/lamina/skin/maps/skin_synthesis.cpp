// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <array>

#include "lamina/base/core/parallel.h"
#include "lamina/base/core/random.h"
#include "lamina/skin/maps/internal/skin_canvas.h"

namespace lamina {
namespace {

/// Middles of tiles, one in each square of a lattice, in its inner half: so the nearest one is
/// never further than 1.06 sides, and all that count beside it lie within two squares.
class TileLattice {
 public:
  static constexpr int around = 2;
  static constexpr std::size_t most = (2 * around + 1) * (2 * around + 1);

  TileLattice(const MapExample& example, const CanvasGrid& grid, std::uint64_t seed)
      : example_(example),
        columns_(squares(grid.across())),
        tiles_(columns_ * squares(grid.down())) {
    for (std::size_t i = 0; i < tiles_.size(); ++i) {
      Random random = make_random(seed + 1, i);
      const auto column = static_cast<double>(i % columns_) - around;
      const auto row = static_cast<double>(i / columns_) - around;
      tiles_[i] = {{example.tile() * (column + 0.25 + 0.5 * random.uniform()),
                    example.tile() * (row + 0.25 + 0.5 * random.uniform())},
                   example.shift_of(seed, i)};
    }
  }

  /// The tiles that count at a place. @return how many
  std::size_t at(CanvasPoint p, std::array<MapExample::Tile, most>& tiles) const {
    const auto first = static_cast<std::size_t>(p.y / example_.tile()) * columns_ +
                       static_cast<std::size_t>(p.x / example_.tile());
    const auto tile = [&](std::size_t n) -> const PlacedTile& {
      constexpr std::size_t side = 2 * around + 1;
      return tiles_[first + n / side * columns_ + n % side];
    };
    std::array<Vec2, most> offset;
    std::array<double, most> distance;
    for (std::size_t n = 0; n < most; ++n) {
      offset[n] = Vec2{p.x, p.y} - tile(n).middle;
      distance[n] = std::hypot(offset[n].x, offset[n].y);
    }
    const double furthest = *std::ranges::min_element(distance) + example_.reach();
    std::size_t count = 0;
    for (std::size_t n = 0; n < most; ++n)
      if (distance[n] < furthest)
        tiles[count++] = {MapExample::place_of(tile(n).shift, offset[n]), distance[n]};
    return count;
  }

 private:
  struct PlacedTile {
    Vec2 middle;
    MapExample::Shift shift;
  };
  [[nodiscard]] std::size_t squares(double length) const {
    return static_cast<std::size_t>(length / example_.tile()) + 1 + 2 * around;
  }
  const MapExample& example_;
  std::size_t columns_;
  std::vector<PlacedTile> tiles_;
};

}  // namespace

void change_by_synthesis(SkinParameters& skin, const Synthesis& synthesis,
                         std::span<const double> values, double share) {
  const MapExample& example = synthesis.example;
  for (std::size_t m = 0; m < values.size(); ++m) {
    double& parameter = mapped_number(skin, example.maps()[m]);
    const double mean = example.mean(m);
    const double value =
        synthesis.are_factors ? parameter * (mean > 0.0 ? values[m] / mean : 1.0) : values[m];
    parameter += share * (value - parameter);
  }
}

void apply_feature(const Synthesis& synthesis, std::uint64_t seed, SkinCanvas& canvas) {
  const TileLattice lattice(synthesis.example, canvas.grid, seed);
  const CanvasGrid& grid = canvas.grid;
  parallel_for(static_cast<std::size_t>(grid.height), [&](std::size_t y) {
    std::array<MapExample::Tile, TileLattice::most> tiles;
    std::array<double, MapExample::most_maps> store;
    const std::span<double> values(store.data(), synthesis.example.maps().size());
    for (std::size_t x = 0; x < static_cast<std::size_t>(grid.width); ++x) {
      const CanvasPoint place = {(static_cast<double>(x) + 0.5) * grid.mm,
                                 (static_cast<double>(y) + 0.5) * grid.mm};
      const std::size_t count = lattice.at(place, tiles);
      synthesis.example.values_at(std::span(tiles).first(count), grid.mm, values);
      change_by_synthesis(canvas.skin[y * static_cast<std::size_t>(grid.width) + x], synthesis,
                          values, 1.0);
    }
  });
}

}  // namespace lamina
