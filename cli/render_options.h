// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "console.h"
#include "lamina/render/render.h"
#include "lamina/scene/description/scene.h"
#include "picture_files.h"
#include "picture_look.h"
#include "shard_option.h"

namespace lamina::cli {

/// Options of `lamina render`.
struct RenderCommandOptions {
  CommonOptions common;
  std::string scene, output, quality, method, profile, cache, single_scattering, shard, region;
  int samples = 0, width = 0, height = 0, max_bounces = -1;
  float noise = -1.0f, clamp = -1.0f;
  bool needs_cache = false, takes_foreign_light = false, resumes = false, keeps = false,
       is_progressive = false, has_alpha = false, has_mattes = false, has_light_layers = false,
       is_stamped = false, starts_anew = false, denoises = false, watches = false, corrects = false,
       only_prepares = false, only_checks = false;
  std::vector<std::string> compared, settings;
  LookOptions look;
  Option seed;
};

/// The scene as it is to be rendered. @throws Error as load_scene, and for what the options ask
[[nodiscard]] Scene load_scene_to_render(const RenderCommandOptions& options);

/// Does what load_scene_to_render does once the scene is loaded.
void prepare_to_render(const RenderCommandOptions& options, Scene& scene);

/// Says warnings.
void warn(const std::vector<std::string>& lines);

/// Where a render keeps its samples while it is at work: a file beside the picture or the shard.
///
/// Samples that an earlier render kept are worth the hours they took: they stay, as is
/// said, unless --resume goes on from it or --fresh replaces it.
///
/// @param file  the picture or the shard
/// @return      empty: the render keeps none
/// @throws      InvalidInput if --keep asks for the place of what is there; WriteError if the file
///              cannot be written, and --keep or --resume needs it
[[nodiscard]] std::filesystem::path checkpoint_beside(const RenderCommandOptions& options,
                                                      const std::filesystem::path& file);

/// Renders and writes the picture.
/// @param checkpoint  as of checkpoint_beside
void render_picture(const RenderCommandOptions& options, const PictureFiles& files,
                    const PictureLook& look, Scene scene,
                    const std::filesystem::path& checkpoint);

/// Options of the command for a picture and for writing it while it grows.
[[nodiscard]] RenderOptions picture_options(const RenderCommandOptions& options,
                                            const PictureFiles& files, const PictureLook& look,
                                            const Film& film);

/// Renders, light by light where that is asked for.
[[nodiscard]] RenderResult render_as_asked(const RenderCommandOptions& options, Scene& scene,
                                           const RenderOptions& how, const Progress& progress);

[[nodiscard]] Progress picture_progress(const RenderCommandOptions& options);

/// Writes a picture and says what is known of it.
/// @param checkpoint  that keeps its samples if it is not complete; empty: none does
void finish_picture(const RenderCommandOptions& options, const PictureFiles& files,
                    const PictureLook& look, Scene scene, RenderResult result,
                    const std::filesystem::path& checkpoint);

/// Renders again whenever one of the files changes that loading the scene has read or looked for.
void watch_picture(const RenderCommandOptions& options, const PictureFiles& files,
                   const PictureLook& look);

/// The options that pictures made light by light cannot have.
void refuse_with_light_layers(const RenderCommandOptions& options, const PictureFiles& files,
                              const Scene& scene);

/// Where the part of --shard goes: beside where the picture would be without the option.
[[nodiscard]] std::filesystem::path shard_file(const RenderCommandOptions& options,
                                               const Shard& shard);

/// The options that a part of the samples cannot have.
void refuse_with_shard(const RenderCommandOptions& options, const Scene& scene);

/// Renders the part of --shard.
/// @param checkpoint  as of checkpoint_beside
void render_shard(const RenderCommandOptions& options, const Scene& scene,
                  const std::filesystem::path& file, const std::filesystem::path& checkpoint);

}  // namespace lamina::cli
