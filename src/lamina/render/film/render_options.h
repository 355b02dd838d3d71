// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/core/shard.h"
#include "lamina/base/image/image.h"

namespace lamina {

class KeptParts;

/// Options that are not part of a scene but of how it is computed. The defaults are right for
/// pictures.
struct RenderOptions {
  /// Ways to sample direct light: next-event estimation of lights, sampling of surfaces, or both by
  /// multiple importance sampling. Each alone converges to the same image; they are for tests,
  /// together they have the least noise.
  enum class DirectLight { combined, lights_only, surfaces_only };
  DirectLight direct_light = DirectLight::combined;

  /// File that keeps the light that the methods `hierarchy` and `texture_space` sample, for other
  /// cameras; empty: none. It is read if it is there and of use: made for this light, whole, and
  /// fine enough. Else the light is sampled and it is written, which on_notice is told.
  std::filesystem::path cache;
  MemoryBudget memory;       ///< for reading the cache
  bool needs_cache = false;  ///< refuses to sample what the cache does not have
  /// Takes the light that the cache has, whoever made it and for whatever scene: neither checksum
  /// nor fingerprint is looked at, and the file stays as it is. What it lacks is refused.
  bool takes_foreign_light = false;

  /// File that keeps an unfinished image, every half minute and at an early stop; removed when the
  /// image is complete. Empty: none.
  std::filesystem::path checkpoint;
  /// Goes on from the checkpoint if there is one: the image is the same. It may have more samples
  /// than were wanted then.
  bool resumes = false;
  bool keeps_samples = false;  ///< leaves the checkpoint of a complete image, for more of them

  /// A part of the samples of all pixels, whose sums go into a file: render/film/film_shard.h adds
  /// them up to the picture, bit by bit. The result then has no image.
  struct Part {
    Shard shard;
    std::filesystem::path file;
    std::string version;               ///< of lamina, for the file
    std::vector<std::string> command;  ///< that makes a part, without shard and file: also for it
  };
  std::optional<Part> part;
  bool has_mattes = false;     ///< adds Cryptomatte layers of objects and materials to the image
  bool only_prepares = false;  ///< ends before the samples: the cache is then made, and profiles

  /// Parts of other pictures of this scene as it was, to take over and to add to: the picture is
  /// the same, but for a first look. Null: none. begin_picture() is called by whoever asks.
  KeptParts* kept = nullptr;
  /// Samples per pixel up to which the work goes on once it has those that are asked for; on_image
  /// is shown the picture after each pass. 0: it ends there.
  int goes_on_to = 0;

  /// Told what a user should know before the work goes on, a line each. May be empty.
  std::function<void(const std::string&)> on_notice;

  /// Shown the image as it grows, as RenderResult has it, from the first sample of all pixels on;
  /// by one thread at a time while the others go on. May be empty.
  std::function<void(const Image&)> on_image;
  double seconds_between_images = 5.0;  ///< at least; showing takes a tenth of the time at most
};

}  // namespace lamina
