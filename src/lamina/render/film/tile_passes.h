// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "lamina/core/progress.h"
#include "lamina/render/film/film_accumulator.h"

namespace lamina {

struct TilePassOptions {
  int samples = 1;     ///< per pixel, at most
  float noise = 0.0f;  ///< standard error over brightness at which a tile ends; 0: none ends early
  std::filesystem::path checkpoint;  ///< file that keeps an unfinished image; empty: none
  std::uint64_t key = 0;             ///< what the image follows from, as in save_checkpoint
  bool resumes = false;              ///< goes on from the checkpoint, if there is one
};

/// Adds samples to all pixels of a film, in passes over the whole frame, so that it is complete
/// though noisy from the first pass on. The result does not depend on the number of threads, nor on
/// being stopped and resumed.
///
/// @param sample  value of a pixel's sample: x, y, index of the sample
/// @return        whether it was completed. If not, the checkpoint holds what there is, if that is
///                anything; else it is removed.
/// @throws        as load_checkpoint, save_checkpoint
[[nodiscard]] bool add_tile_passes(const std::function<CameraSample(int, int, int)>& sample,
                                   const TilePassOptions& options, const Progress& progress,
                                   FilmAccumulator& film);

}  // namespace lamina
