// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/io/files_read.h"
#include "render_options.h"
#include "watched_files.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

/// The options that do not go with pictures made again and again.
void refuse_with_watch(const RenderCommandOptions& options) {
  for (const auto& [name, is_given] :
       {std::pair{"--resume", options.resumes}, std::pair{"--keep", options.keeps},
        std::pair{"--fresh", options.starts_anew}, std::pair{"--shard", !options.shard.empty()},
        std::pair{"--prepare", options.only_prepares}, std::pair{"--check", options.only_checks},
        std::pair{"--compare", !options.compared.empty()}})
    if (is_given) throw InvalidInput(std::string(name) + ": does not go with --watch");
  std::error_code ignored;
  if (!fs::exists(options.scene, ignored) && options.scene != "-")
    throw FileError(options.scene + ": there is no such file");
  if (!fs::is_regular_file(options.scene, ignored))
    throw InvalidInput("--watch: the scene must be a file, but is " + options.scene);
}

}  // namespace

void watch_picture(const RenderCommandOptions& options, const PictureFiles& files,
                   const PictureLook& look) {
  refuse_with_watch(options);
  while (true) {
    FilesRead reading;
    std::optional<WatchedFiles> watched;
    try {
      Scene scene = load_scene_to_render(options);
      if (options.has_light_layers) refuse_with_light_layers(options, files, scene);
      watched.emplace(reading.files());
      render_picture(options, files, look, std::move(scene), {},
                     [&] { return watched->has_changed(); });
    } catch (const Interrupted&) {
      throw;
    } catch (const Error& error) {
      say(error.what());
      if (!watched) watched.emplace(reading.files());
    }
    if (was_interrupted()) return;
    if (!watched->has_changed())
      say(fmt::format("waiting for changes of {} file{}; Ctrl-C ends", watched->count(),
                      watched->count() == 1 ? "" : "s"));
    rest_between_works();
    watched->wait_for_change();
    const std::string changed = watched->name_of_changed();
    say(changed.empty() ? "files have changed" : changed + " has changed");
  }
}

}  // namespace lamina::cli
