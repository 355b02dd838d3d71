// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/io/files_read.h"
#include "lamina/render/render_session.h"
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
  RenderSession::Options how{.memory = options.common.memory,
                             .has_small_pictures = false,
                             .goes_on = false,
                             .on_notice = say,
                             .on_error = say};
  how.prepare = [&](Scene& scene) {
    prepare_to_render(options, scene);
    if (options.has_light_layers) refuse_with_light_layers(options, files, scene);
  };
  how.render = [&](Scene& scene, const RenderOptions& given, const Progress& progress) {
    RenderOptions all = picture_options(options, files, look, scene.film);
    if (!options.has_light_layers) all.kept = given.kept;  // those change the lights
    return render_as_asked(options, scene, all, progress);
  };
  how.progress = [&] { return picture_progress(options); };
  how.on_result = [&](const Scene& scene, RenderResult result) {
    finish_picture(options, files, look, scene, std::move(result), {});
  };
  std::unique_ptr<RenderSession> session;
  while (true) {
    std::optional<WatchedFiles> watched;
    {
      const FilesRead reading;
      try {
        if (session)
          session->reload();
        else
          session = std::make_unique<RenderSession>(options.scene, options.settings, how);
      } catch (const Error& error) {
        say(error.what());
      }
      watched.emplace(reading.files());
    }
    while (session && session->status().is_working && !watched->has_changed())
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (was_interrupted()) return;
    if (watched->has_changed()) {
      if (session) session->cancel();
    } else {
      say(fmt::format("waiting for changes of {} file{}; Ctrl-C ends", watched->count(),
                      watched->count() == 1 ? "" : "s"));
    }
    rest_between_works();
    watched->wait_for_change();
    const std::string changed = watched->name_of_changed();
    say(changed.empty() ? "files have changed" : changed + " has changed");
  }
}

}  // namespace lamina::cli
