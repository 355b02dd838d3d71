// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "lamina/base/core/progress.h"
#include "lamina/render/film/film_accumulator.h"

namespace lamina {

struct TilePassOptions {
  int samples = 1;     ///< per pixel, at most
  int goes_on_to = 0;  ///< samples per pixel beyond those, if more; all passes are then shown
  float noise = 0.0f;  ///< standard error over brightness at which a tile ends; 0: none ends early
  std::filesystem::path checkpoint;  ///< file that keeps an unfinished image; empty: none
  std::uint64_t key = 0;             ///< what the image follows from, as in save_checkpoint
  std::uint64_t light = 0;           ///< what was prepared by the number of samples
  bool resumes = false;              ///< goes on from the checkpoint, if there is one
  bool keeps = false;  ///< the checkpoint of the complete image, too, for more samples
  /// Shown the image as it grows, from the first pass over the frame on, by one thread at a time
  /// while the others go on. May be empty.
  std::function<void(const Image&)> on_image;
  /// Image of a film, where it is more than the film's own. May be empty.
  std::function<Image(const FilmAccumulator&)> image_of;
  /// Told why the checkpoint cannot be written, the image going on without; "" once it is there
  /// after all. May be empty.
  std::function<void(const std::string& why)> on_checkpoint;
  std::chrono::duration<double> between_images{
      5.0};  ///< at least; images take a tenth of the time at most
};

/// Samples per pixel that a checkpoint keeps.
struct KeptSamples {
  std::int64_t least = 0, most = 0;
};

/// Samples in a checkpoint, from its first bytes: damage behind them is not seen.
/// @return  absent if it is no checkpoint of this version
[[nodiscard]] std::optional<KeptSamples> kept_samples(const std::filesystem::path& file);

/// Adds samples to all pixels of a film, in passes over the whole frame, so that it is complete
/// though noisy from the first pass on. The result does not depend on the number of threads, nor on
/// being stopped and resumed; a complete image that is resumed with more samples becomes the one
/// that all of them at once make, if no tile ends early.
///
/// @param sample  value of a pixel's sample: x, y, index of the sample
/// @return        whether it was completed. If not, the checkpoint holds what there is, if that is
///                anything; else it is removed, or kept if asked for.
/// @throws        as load_checkpoint; FileError if the checkpoint has more samples than are wanted,
/// or
///                if what was prepared for it is not what is prepared for as many as are wanted
[[nodiscard]] bool add_tile_passes(const std::function<CameraSample(int, int, int)>& sample,
                                   const TilePassOptions& options, const Progress& progress,
                                   FilmAccumulator& film);

}  // namespace lamina
