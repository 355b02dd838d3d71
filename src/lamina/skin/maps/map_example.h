// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/skin/maps/skin_maps.h"

namespace lamina {

/// The maps of a small piece of skin, ready to be spread over a larger one without a visible
/// repetition or seam.
///
/// A place sees a few tiles, each of them the example shifted and turned at random, the same for
/// all maps. Values go in as normal deviates, by their ranks, and are added with weights whose
/// squares sum to 1; so the sum is normal, and its rank gives a value: every map keeps its mean and
/// its histogram, and what lies together in the example lies together on the skin. Fine detail
/// passes from tile to tile within a tenth of a tile, coarse detail over a whole one.
///
/// Beyond its edges the example goes on as its mirror image. What is longer than a tile, such as a
/// vein, is cut; a mark that catches the eye comes again.
///
/// Source: [HeitzNeyret2018]; a transition per band: [BurtAdelson1983].
class MapExample {
 public:
  /// @param maps          at most `most_maps` of one size, at least `least_side` texels each way
  /// @param mm_per_texel  > 0
  /// @param tile          distance between tiles [mm], > 0, at most the shorter side of the maps
  MapExample(std::vector<SkinMap> maps, double mm_per_texel, double tile);
  static constexpr int least_side = 16;
  static constexpr std::size_t most_maps = 16;

  [[nodiscard]] double tile() const { return tile_; }
  /// Maps of the example; their images are empty.
  [[nodiscard]] std::span<const SkinMap> maps() const { return maps_; }
  [[nodiscard]] double mean(std::size_t map) const { return means_[map]; }

  /// How much further away than the nearest tile others still count [mm].
  [[nodiscard]] double reach() const { return tile_; }

  /// How a tile lies in the example.
  struct Shift {
    Vec2 middle;       ///< [mm]
    double cos, sin;   ///< of its turn
    bool is_mirrored;  ///< before it is turned
  };
  /// Shift of a tile of a given number.
  [[nodiscard]] Shift shift_of(std::uint64_t seed, std::uint64_t tile) const;

  /// A tile as a place sees it.
  struct Tile {
    Vec2 place;       ///< in the example [mm]
    double distance;  ///< from the middle of the tile [mm]
  };
  /// @param offset  of the place from the tile's middle [mm]
  [[nodiscard]] static Vec2 place_of(const Shift& shift, const Vec2& offset);

  /// Values of the maps at a place.
  /// @param tiles   all within `reach` of the nearest, at least one
  /// @param width   of the texel there [mm]; detail that is finer is averaged
  /// @param values  [map], the result
  void values_at(std::span<const Tile> tiles, double width, std::span<double> values) const;

 private:
  /// The example in texels of one size; arrays are [y][x][map] where they are not sorted.
  struct Level {
    int width = 0, height = 0;
    double mm = 0.0;                         ///< per texel
    std::vector<float> fine, coarse;         ///< the two bands of the deviates
    std::vector<double> shared;              ///< covariance of the bands [map]
    std::vector<std::vector<float>> sorted;  ///< all values, ascending [map]
  };
  [[nodiscard]] Level make_level(const std::vector<Image>& values, double mm) const;
  void level_values(const Level& level, std::span<const Tile> tiles,
                    std::span<double> values) const;

  std::vector<SkinMap> maps_;
  std::vector<double> means_;
  double tile_;
  std::vector<Level> levels_;  ///< each of texels twice as wide as the one before
};

}  // namespace lamina
