// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lamina/acquire/inversion/patch_inversion.h"

namespace lamina {

/// Texels from (x, y) on.
struct TexelRectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

/// A part of a large capture, and what is inverted with it, so that light and smoothness from
/// around it are right.
struct PatchTile {
  TexelRectangle kept, inverted;
};

struct TileOptions {
  int side = 512;     ///< of what is kept [texel], > 0
  double halo = 2.5;  ///< around it [mm], >= 0: a few times as far as light goes in skin
};

/// Tiles that cover a capture, row by row.
/// @throws InvalidInput for options out of range.
[[nodiscard]] std::vector<PatchTile> patch_tiles(const PatchCapture& capture,
                                                 const TileOptions& options = {});

/// The part of a capture in a rectangle that lies within it.
[[nodiscard]] PatchCapture part_of(const PatchCapture& capture, const TexelRectangle& part);

/// A tile's maps, of the size of what is kept. It follows from its arguments alone, so that tiles
/// can be inverted anywhere and in any order; about .2 GiB at a time for each wavelength of a tile
/// of 512 texels and its halo. A tile of which nothing is known has the reference skin of the
/// tables.
///
/// @param options  with the smoothness given, else each tile chooses its own and seams may show;
///                 that of one tile serves all. A start is of the size of the capture
[[nodiscard]] InversionResult invert_tile(const PatchCapture& capture,
                                          const InversionTables& tables, const PatchTile& tile,
                                          const InversionOptions& options = {},
                                          const Progress& progress = {});

/// Puts maps and residuals of a tile in their place of those of the whole capture, which are made
/// where there are none yet.
void put_tile(const PatchCapture& capture, const PatchTile& tile, const InversionResult& part,
              InversionResult& whole);

/// All tiles one after the other, with the smoothness of the one of which most is known. History
/// and correlation are that tile's.
///
/// @param progress  asked to stop, tiles that are left have the reference skin of the tables
[[nodiscard]] InversionResult invert_tiles(const PatchCapture& capture,
                                           const InversionTables& tables,
                                           const TileOptions& tiling = {},
                                           const InversionOptions& options = {},
                                           const Progress& progress = {});

}  // namespace lamina
