// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/render/render.h"
#include "picture_files.h"
#include "render_options.h"
#include "shard_option.h"

namespace lamina::cli {

namespace fs = std::filesystem;

fs::path shard_file(const RenderCommandOptions& options, const Shard& shard) {
  if (lower_case_ending(options.output) == ".shard") return options.output;
  std::error_code ignored;
  if (!options.output.empty() && !fs::is_directory(options.output, ignored))
    throw InvalidInput("--output: must end in .shard with --shard, but is " + options.output);
  return fs::path(options.output) / fmt::format("{}.{}-of-{}.shard",
                                                named_after(options.scene, "shard"), shard.index,
                                                shard.count);
}

void refuse_with_shard(const RenderCommandOptions& options, const Scene& scene) {
  for (const auto& [name, is_given] :
       {std::pair{"--keep", options.keeps}, std::pair{"--progressive", options.is_progressive},
        std::pair{"--cryptomatte", options.has_mattes},
        std::pair{"--light-layers", options.has_light_layers},
        std::pair{"--stamp", options.is_stamped}, std::pair{"--ocio", !options.look.ocio.empty()},
        std::pair{"--display", !options.look.display.empty()},
        std::pair{"--color-space", options.look.space != RgbSpace::rec709}})
    if (is_given) throw InvalidInput(std::string(name) + ": does not go with --shard");
  if (options.denoises)
    throw InvalidInput("--denoise: is for `lamina merge`, which has all samples, not for --shard");
  if (options.noise > 0.0f || scene.render.noise > 0.0f)
    throw InvalidInput(
        "--noise: does not go with --shard, which does not know the noise of the others; `lamina "
        "merge --noise` tells it. Where the scene file has it, --noise 0");
}

void render_shard(const RenderCommandOptions& options, const Scene& scene, const fs::path& file,
                  const fs::path& checkpoint) {
  const auto say_how_to_go_on = [&] {
    if (fs::exists(checkpoint))
      say("stopped early; the same command with --resume goes on from " + checkpoint.string());
  };
  RenderResult result;
  try {
    result = render(scene,
                    {.cache = options.cache,
                     .memory = options.common.memory,
                     .needs_cache = options.needs_cache,
                     .takes_foreign_light = options.takes_foreign_light,
                     .checkpoint = checkpoint,
                     .resumes = options.resumes,
                     .part = RenderOptions::Part{.shard = read_shard(options.shard),
                                                 .file = file,
                                                 .version = LAMINA_VERSION,
                                                 .command = words_of_shards(words_of_call())},
                     .on_notice = say},
                    make_progress("rendering"));
  } catch (const Interrupted&) {
    say_how_to_go_on();
    throw;
  }
  const RenderStatistics& s = result.statistics;
  warn(s.warnings);
  if (!s.is_complete) {
    say_how_to_go_on();
    throw Interrupted();
  }
  JsonOutput json = make_result("render");
  json["method"] = std::string(s.method.name());
  json["shard"] = options.shard;
  json["wall_seconds"] = s.wall_seconds;
  json["cpu_seconds"] = s.cpu_seconds;
  json["samples_per_pixel"] = s.samples_per_pixel;
  json["peak_memory_mib"] = s.peak_memory_mib;
  write_json(json, options.common);
  print(options.common,
        fmt::format("{}\n{:.1f} s wall, {:.1f} s CPU, {:.4g} samples per pixel, {:.0f} MiB\n",
                    file.string(), s.wall_seconds, s.cpu_seconds, s.samples_per_pixel,
                    s.peak_memory_mib));
}

}  // namespace lamina::cli
