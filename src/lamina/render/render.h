// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/files/image_frame.h"
#include "lamina/base/image/image.h"
#include "lamina/render/film/render_options.h"
#include "lamina/render/subsurface/preparation_report.h"
#include "lamina/scene/description/scene.h"

namespace lamina {

/// Where the profile of a material comes from.
struct ProfileUse {
  std::uint32_t material = 0;  ///< index
  RenderSettings::Profile source = RenderSettings::Profile::radiative_transfer;
};

struct RenderStatistics {
  SceneMethod method;                 ///< that was used
  std::string why_method;             ///< a phrase, if the scene left it open; else empty
  bool is_corrected = false;          ///< by random walks, as the scene or its quality asked
  double expected_cpu_seconds = 0.0;  ///< as it seemed before the work
  double expected_memory_mib = 0.0;   ///< of the process, without what methods prepare
  double wall_seconds = 0.0;
  double cpu_seconds = 0.0;                  ///< of all threads of the process while rendering
  double samples_per_pixel = 0.0;            ///< mean; fewer than asked for after an early stop
  std::optional<double> relative_noise;      ///< see base/image/compare.h, of the pixels that show
                                             ///< nothing but translucent surfaces, or, where there
                                             ///< are none, nothing but surfaces
  std::optional<double> relative_noise_rms;  ///< of the same, with outliers
  double peak_memory_mib = 0.0;              ///< of the process so far
  bool is_complete = true;                   ///< false if progress asked to stop
  std::vector<LightSamples> light_samples;   ///< of method `hierarchy`
  std::vector<LightCorrection> corrections;  ///< where RenderSettings::is_corrected
  std::vector<ProfileUse> profiles;          ///< of methods that take profiles
  std::vector<std::string> warnings;         ///< one line each: texture coordinates that overlap
  std::string unkept;  ///< why RenderOptions::checkpoint could not be written at last; else empty
};

struct RenderResult {
  /// Channels R, G, B (linear Rec.709), subsurface.*, specular.*, albedo.* (R, G, B), normal.X, .Y,
  /// .Z (outward, world space), depth.Z [mm, infinite where nothing is], samples, and variance (of
  /// the pixel's luminance, if its samples were independent; stratification makes it smaller).
  /// With Film::has_alpha also A, with RenderOptions::has_mattes CryptoObject00.R to
  /// CryptoMaterial02.A. Empty where RenderOptions asks for a part, or for preparation alone.
  Image image;
  /// Notes for the picture's file: version, method, seed, camera and how it was meant to be seen,
  /// as attributes lamina/…; with mattes their manifests.
  std::vector<ImageNote> notes;
  RenderStatistics statistics;
};

/// Where the picture of a film lies, if it is a region.
[[nodiscard]] inline ImageFrame frame_of(const Film& film) {
  if (!film.region) return {};
  return {.x = film.region->x, .y = film.region->y, .width = film.width, .height = film.height};
}

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

}  // namespace lamina
