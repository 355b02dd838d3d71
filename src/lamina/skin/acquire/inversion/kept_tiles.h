// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "lamina/base/core/shard.h"
#include "lamina/skin/acquire/inversion/patch_inversion.h"

namespace lamina {

/// A folder that keeps the tiles of a large capture, so that many machines can share them and
/// nothing is done twice.
struct KeptTiles {
  std::filesystem::path folder;
  std::uint64_t key = 0;  ///< of all that the tiles follow from
  /// Shard of the tiles to be inverted, apart from the first, whose smoothness all need; absent:
  /// all
  std::optional<Shard> shard = {};
  bool only_first = false;
};

/// The maps of the part of a capture that is kept of a tile; absent if there are none, or they are
/// damaged or of another key.
[[nodiscard]] std::optional<InversionResult> load_tile(const KeptTiles& tiles,
                                                       const TexelRectangle& kept);

/// @throws WriteError
void save_tile(const KeptTiles& tiles, const TexelRectangle& kept, const InversionResult& result);

}  // namespace lamina
