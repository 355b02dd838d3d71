// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lamina/core/memory_budget.h"
#include "lamina/core/progress.h"
#include "lamina/image/image.h"
#include "lamina/render/scene.h"

namespace lamina {

/// What is not part of a scene but of how it is computed. The defaults are right for pictures.
struct RenderOptions {
  /// How light leaves a translucent surface over the angle.
  enum class ExitAngle {
    conserving,  ///< as much in total as the profile says: transmittance over its projected
                 ///< integral
    printed,     ///< transmittance / pi, [DonnerJensen2005] Eqs. 2 and 25: loses that share twice
  };
  ExitAngle exit_angle = ExitAngle::conserving;

  /// How directions are drawn. Each alone converges to the same image, combined is the least noisy.
  enum class DirectLight { combined, lights_only, surfaces_only };
  DirectLight direct_light = DirectLight::combined;

  /// File that keeps the light that the methods `hierarchy` and `texture_space` sample, for other
  /// cameras; empty: none. It is read if it is there and of use: made for this light, whole, and
  /// fine enough. Else the light is sampled and it is written, which on_notice is told.
  std::filesystem::path cache;
  MemoryBudget memory;       ///< for reading the cache
  bool needs_cache = false;  ///< refuses to sample what the cache does not have

  /// File that keeps an unfinished image, every half minute and at an early stop; removed when the
  /// image is complete. Empty: none.
  std::filesystem::path checkpoint;
  bool resumes = false;  ///< goes on from the checkpoint if there is one: the image is the same

  /// Told what a user should know before the work goes on, a line each. May be empty.
  std::function<void(const std::string&)> on_notice;
};

/// How the method `hierarchy` has sampled the light on a material.
struct LightSamples {
  std::uint32_t material = 0;  ///< index into those of the scene
  double spacing = 0.0;        ///< [mm]
  std::size_t count = 0;
  std::optional<double> change;  ///< of the light that leaves, from twice the spacing: root mean
                                 ///< square over that of the light. Absent without refinement
};

struct RenderStatistics {
  RenderSettings::Method method = RenderSettings::Method::automatic;  ///< that was used
  std::string why_method;             ///< a phrase, if the scene left it open; else empty
  double expected_cpu_seconds = 0.0;  ///< as it seemed before the work
  double wall_seconds = 0.0;
  double cpu_seconds = 0.0;                 ///< of all threads of the process while rendering
  double samples_per_pixel = 0.0;           ///< mean; fewer than asked for after an early stop
  std::optional<double> relative_noise;     ///< see relative_noise()
  double peak_memory_mib = 0.0;             ///< of the process so far
  bool is_complete = true;                  ///< false if progress asked to stop
  std::vector<LightSamples> light_samples;  ///< of method `hierarchy`
  std::vector<std::string> warnings;        ///< one line each: texture coordinates that overlap
};

struct RenderResult {
  /// Channels R, G, B (linear Rec.709), subsurface.*, specular.*, albedo.* (R, G, B), normal.X, .Y,
  /// .Z (outward, world space), depth.Z [mm, infinite where nothing is], samples, and variance (of
  /// the pixel's luminance, if its samples were independent; stratification makes it smaller).
  Image image;
  RenderStatistics statistics;
};

/// Renders a scene as its render settings ask.
///
/// Passes over the whole frame double the samples each time, so an early stop leaves a complete but
/// noisier image, from the end of the first pass on. The result depends on scene and seed, not on
/// the number of threads.
///
/// @throws InvalidInput if the scene cannot be rendered: materials of different bands, more than 16
///         bands, a method that does not exist yet, a cache that is needed but of no use.
/// @throws FileError, WriteError if the cache is another file, or cannot be read or written;
/// FileError if the
///         checkpoint to go on from is damaged, or of another scene or other settings.
/// @throws Interrupted if progress asked to stop before every pixel had a sample. What there is of
///         them, the checkpoint keeps.
[[nodiscard]] RenderResult render(const Scene& scene, const RenderOptions& options = {},
                                  const Progress& progress = {});

/// Median over lit pixels of |pixel - mean of its 4 neighbours| over that mean, in luminance. Fine
/// texture counts as noise. Absent if there is no such pixel.
///
/// @param image        an image as render() makes it
/// @param is_measured  [y][x], whether a pixel counts: render() takes those that show nothing but
///                     translucent surfaces, or, where there are none, nothing but surfaces
[[nodiscard]] std::optional<double> relative_noise(const Image& image,
                                                   const std::vector<bool>& is_measured);

}  // namespace lamina
