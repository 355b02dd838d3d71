// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "lamina/skin/acquire/inversion/kept_tiles.h"
#include "lamina/skin/acquire/inversion/patch_inversion.h"

namespace lamina {

/// A capture too large to be held as a whole in the form that inversions take.
struct LargePatch {
  int width = 0, height = 0;  ///< [texel]
  double mm_per_texel = 0.1;
  /// The photographs in a rectangle that lies within it.
  std::function<PatchCapture(const TexelRectangle&)> part;
  /// [number] values in a rectangle to go on from, as InversionOptions has them; absent: none
  std::function<std::vector<Plane>(const TexelRectangle&)> start = {};
};

/// A part of a large capture, and what is inverted with it, so that light and smoothness from
/// around it are right.
struct PatchTile {
  TexelRectangle kept, inverted;
};

struct TileOptions {
  int side = 512;     ///< of what is kept [texel], > 0
  double halo = 2.5;  ///< around it [mm], >= 0: a few times as far as light goes in skin
  std::optional<KeptTiles> kept = {};  ///< takes tiles from there, and keeps them there
};

/// Memory that invert_patch takes for each texel of each light at each wavelength, about [bytes].
inline constexpr double inversion_bytes_per_texel = 550.0;

/// The side of tiles [texel] that invert_tile takes so much memory for with their halo; at least
/// 64, however much that is.
///
/// @param fields  wavelengths of all lights together
/// @param halo    [mm]
[[nodiscard]] int side_of_tiles(double bytes, std::size_t fields, double mm_per_texel, double halo);

/// Tiles that cover so many texels, row by row.
/// @throws InvalidInput for options out of range.
[[nodiscard]] std::vector<PatchTile> patch_tiles(int width, int height, double mm_per_texel,
                                                 const TileOptions& options = {});

/// The part of a plane or of a capture in a rectangle that lies within it.
[[nodiscard]] Plane part_of(const Plane& plane, const TexelRectangle& part);
[[nodiscard]] PatchCapture part_of(const PatchCapture& capture, const TexelRectangle& part);

/// A tile's maps, of the size of what is kept. It follows from its arguments alone, so that tiles
/// can be inverted anywhere and in any order. A tile of which nothing is known has the start, or
/// the reference skin of the tables, and neither standard deviations nor residuals.
///
/// @param capture  the part of the whole in tile.inverted
/// @param options  with the smoothness given, else each tile chooses its own and seams may show;
///                 that of one tile serves all. A start is of the size of this part
[[nodiscard]] InversionResult invert_tile(const PatchCapture& capture,
                                          const InversionTables& tables, const PatchTile& tile,
                                          const InversionOptions& options = {},
                                          const Progress& progress = {});

/// Puts maps and residuals of a tile in their place of those of a whole of so many texels, which
/// are made where there are none yet.
void put_tile(int width, int height, const PatchTile& tile, const InversionResult& part,
              InversionResult& whole);

/// All tiles one after the other, that of which most is known first; its smoothness serves all.
///
/// @param take      is handed each tile with its maps; tiles that are left when progress asks to
///                  stop are as those of which nothing is known. It is not handed those that are
///                  left to other machines
/// @return  history, smoothness, growth of errors and correlation of the first tile and what all
///          leave, without maps
/// @throws InvalidInput as check_capture, for tiling and options out of range; WriteError if a
///         tile cannot be kept
[[nodiscard]] InversionResult invert_tiles(
    const LargePatch& patch, const InversionTables& tables, const TileOptions& tiling,
    const InversionOptions& options,
    const std::function<void(const PatchTile&, const InversionResult&)>& take,
    const Progress& progress = {});

/// Inverts a capture that is held, with its maps.
/// @param options  a start is of the size of the capture
[[nodiscard]] InversionResult invert_tiles(const PatchCapture& capture,
                                           const InversionTables& tables,
                                           const TileOptions& tiling = {},
                                           const InversionOptions& options = {},
                                           const Progress& progress = {});

}  // namespace lamina
