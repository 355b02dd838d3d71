// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "lamina/render/film/film_accumulator.h"

namespace lamina {

/// How far an image has got, tile by tile.
struct TileProgress {
  int from = 0;                        ///< samples per pixel of all tiles before the current pass
  std::vector<std::int32_t> samples;   ///< [tile] per pixel
  std::vector<std::uint8_t> is_quiet;  ///< [tile] whether it needs no more
  float noise = 0.0f;                  ///< for which it does not
  std::uint64_t light = 0;             ///< what was prepared follows from
};

/// Writes an unfinished image to a file, whole or not at all. `key` is a number that the image
/// follows from. @throws WriteError
void save_checkpoint(const std::filesystem::path& file, std::uint64_t key,
                     const FilmAccumulator& film, const TileProgress& tiles);

/// Reads back what save_checkpoint wrote, into a film of the same size, which is not to be used
/// where it throws.
///
/// @return absent if there is no such file
/// @throws FileError if it is no checkpoint, damaged, or of an image with another key
[[nodiscard]] std::optional<TileProgress> load_checkpoint(const std::filesystem::path& file,
                                                          std::uint64_t key, FilmAccumulator& film);

}  // namespace lamina
