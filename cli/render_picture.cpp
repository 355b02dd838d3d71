// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <ctime>
#include <filesystem>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/image/denoise.h"
#include "lamina/render/light_layers.h"
#include "lamina/render/render.h"
#include "lamina/scene/description/skin_totals.h"
#include "render_options.h"
#include "shard_option.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

/// What a file says of how it was made beyond what the same command always makes.
std::vector<ImageNote> stamp(const RenderCommandOptions& options, const RenderStatistics& s) {
  const std::time_t now = std::time(nullptr);
  std::tm time{};
  gmtime_r(&now, &time);
  return {{"lamina/scene", options.scene},
          {"lamina/command", fmt::format("lamina {}", fmt::join(words_of_call(), " "))},
          {"lamina/date",
           fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", 1900 + time.tm_year, 1 + time.tm_mon,
                       time.tm_mday, time.tm_hour, time.tm_min, time.tm_sec)},
          {"lamina/wall_seconds", fmt::format("{:.3f}", s.wall_seconds)},
          {"lamina/cpu_seconds", fmt::format("{:.3f}", s.cpu_seconds)},
          {"lamina/samples_per_pixel", fmt::format("{:g}", s.samples_per_pixel)}};
}

PictureLook::OfScene of_film(const Film& film) {
  return {film.view, static_cast<double>(film.exposure), frame_of(film)};
}

/// Writes pictures as they grow. One that cannot be written is said once: the last may fit again.
std::function<void(const Image&)> make_writer(const Film& film, const PictureFiles& files,
                                              const PictureLook& look) {
  return [&film, &files, &look, has_failed = false](const Image& image) mutable {
    try {
      (void)look.write(image, files, {}, of_film(film));
    } catch (const WriteError& error) {
      if (!has_failed) say(std::string("warning: ") + error.what());
      has_failed = true;
    }
  };
}

/// Lines on skin, on samples of the light and on its correction.
std::string describe_materials(const Scene& scene, const RenderStatistics& s) {
  std::string lines;
  for (const SkinTotals& totals : skin_totals(scene))
    lines += describe_skin_totals(totals, scene) + "\n";
  for (const LightSamples& light : s.light_samples)
    lines +=
        fmt::format("{}: {} samples of the light, {:.3g} mm apart{}\n",
                    scene.materials[light.material].name, light.count, light.spacing,
                    light.change ? fmt::format("; twice as far apart the light differs by {:.2g} %",
                                               100.0 * *light.change)
                                 : "");
  for (const LightCorrection& correction : s.corrections) {
    const std::string& name = scene.materials[correction.material].name;
    if (correction.walks == 0) {
      lines += fmt::format("{}: stopped before its light was corrected: planar light\n", name);
      continue;
    }
    const std::string part =
        correction.share < 1.0 ? fmt::format(" ({:.0f} % of those wanted)", 100.0 * correction.share)
                               : "";
    lines += fmt::format(
        "{}: light corrected by {:.2g} million random walks{}, {:.2g} % of it; about {:.2g} % of "
        "error left\n",
        name, 1e-6 * static_cast<double>(correction.walks), part, 100.0 * correction.change,
        100.0 * correction.error_left);
  }
  return lines;
}

/// Entries on materials: how their light was sampled, corrected and spread.
void add_materials(const Scene& scene, const RenderStatistics& s, JsonOutput& json) {
  for (const LightSamples& light : s.light_samples) {
    auto& entry = json["light_samples"].emplace_back();
    entry["material"] = scene.materials[light.material].name;
    entry["spacing_mm"] = light.spacing;
    entry["count"] = light.count;
    if (light.change) entry["change"] = *light.change;
  }
  for (const LightCorrection& correction : s.corrections)
    json["corrections"].push_back({{"material", scene.materials[correction.material].name},
                                   {"walks", correction.walks},
                                   {"change", correction.change},
                                   {"error_left", correction.error_left},
                                   {"share", correction.share}});
  for (const ProfileUse& use : s.profiles)
    json["profiles"].push_back(
        {{"material", scene.materials[use.material].name}, {"profile", name_of(use.source)}});
}

/// Entries on the scene's recipes of skin and on bands that were changed.
void add_recipes(const Scene& scene, JsonOutput& json) {
  for (const SkinTotals& totals : skin_totals(scene))
    json["skin"].push_back({{"material", scene.materials[totals.material].name},
                            {"constants", name_of(totals.constants)},
                            {"totals", totals.by_transfer ? "radiative_transfer" : "diffusion"}});
  for (const BandChange& change : scene.band_changes) {
    auto& entry = json["band_changes"].emplace_back();
    entry["material"] = scene.materials[change.material].name;
    if (!change.covering.empty()) entry["over"] = change.covering;
    entry["from"] =
        change.from.is_rgb() ? JsonOutput("rgb") : JsonOutput(change.from.wavelengths());
    entry["color_error"] = change.color_error;
  }
}

JsonOutput picture_json(const RenderCommandOptions& options, const Scene& scene,
                        const RenderStatistics& s) {
  JsonOutput json = make_result("render");
  json["method"] = std::string(s.method.name());
  if (!s.why_method.empty()) json["method_chosen_because"] = s.why_method;
  if (const auto quality = scene.render.quality) json["quality"] = name_of(*quality);
  json["is_corrected"] = s.is_corrected;
  json["expected_cpu_seconds"] = s.expected_cpu_seconds;
  json["expected_memory_mib"] = s.expected_memory_mib;
  json["wall_seconds"] = s.wall_seconds;
  json["cpu_seconds"] = s.cpu_seconds;
  json["samples_per_pixel"] = s.samples_per_pixel;
  if (s.relative_noise) json["relative_noise"] = *s.relative_noise;
  if (s.relative_noise_rms) json["relative_noise_rms"] = *s.relative_noise_rms;
  json["peak_memory_mib"] = s.peak_memory_mib;
  add_materials(scene, s, json);
  if (options.has_light_layers)
    for (const LightGroup& group : light_groups(scene)) json["light_layers"].push_back(group.name);
  json["width"] = scene.film.width;
  json["height"] = scene.film.height;
  if (const auto& region = scene.film.region)
    json["region"] = JsonOutput::array({region->x, region->y, region->width, region->height});
  json["is_complete"] = s.is_complete;
  add_recipes(scene, json);
  json["warnings"] = scene.warnings;
  for (const std::string& warning : s.warnings) json["warnings"].push_back(warning);
  return json;
}

}  // namespace

RenderOptions picture_options(const RenderCommandOptions& options, const PictureFiles& files,
                              const PictureLook& look, const Film& film) {
  return {.cache = options.cache,
          .memory = options.common.memory,
          .needs_cache = options.needs_cache,
          .takes_foreign_light = options.takes_foreign_light,
          .has_mattes = options.has_mattes,
          .on_notice = say,
          .on_image = options.is_progressive ? make_writer(film, files, look) : nullptr};
}

RenderResult render_as_asked(const RenderCommandOptions& options, Scene& scene,
                             const RenderOptions& how, const Progress& progress) {
  return options.has_light_layers ? render_light_layers(scene, how, progress)
                                  : render(scene, how, progress);
}

Progress picture_progress(const RenderCommandOptions& options) {
  return make_progress("rendering",
                       options.has_light_layers ? Keeps::nothing : Keeps::what_there_is);
}

namespace {

void say_how_to_go_on(const fs::path& checkpoint) {
  if (fs::exists(checkpoint))
    say("stopped early; the same command with --resume goes on from " + checkpoint.string());
}

}  // namespace

void render_picture(const RenderCommandOptions& options, const PictureFiles& files,
                    const PictureLook& look, Scene scene, const fs::path& checkpoint) {
  RenderOptions how = picture_options(options, files, look, scene.film);
  how.checkpoint = checkpoint;
  how.resumes = options.resumes;
  how.keeps_samples = options.keeps;
  RenderResult result;
  try {
    result = render_as_asked(options, scene, how, picture_progress(options));
  } catch (const Interrupted&) {
    say_how_to_go_on(checkpoint);
    throw;
  }
  finish_picture(options, files, look, std::move(scene), std::move(result), checkpoint);
}

void finish_picture(const RenderCommandOptions& options, const PictureFiles& files,
                    const PictureLook& look, Scene scene, RenderResult result,
                    const fs::path& checkpoint) {
  if (options.denoises) {
    const Progress denoising = make_progress("denoising");
    result.image = denoise(result.image);
  }
  std::vector<ImageNote> notes = std::move(result.notes);
  notes.push_back({"lamina/version", LAMINA_VERSION});
  if (options.is_stamped)
    std::ranges::move(stamp(options, result.statistics), std::back_inserter(notes));
  const std::string written = look.write(result.image, files, notes, of_film(scene.film));

  const RenderStatistics& s = result.statistics;
  warn(s.warnings);
  if (!s.is_complete) say_how_to_go_on(checkpoint);
  scene.render.method = s.method;  // where it was left open
  write_json(picture_json(options, scene, s), options.common);
  print(options.common,
        fmt::format("{}{}\n{}{:.1f} s wall, {:.1f} s CPU, {:.4g} samples per pixel, {}{:.0f} MiB\n",
                    s.is_complete ? "" : "stopped early: ", written, describe_materials(scene, s),
                    s.wall_seconds, s.cpu_seconds, s.samples_per_pixel,
                    describe_noise(s.relative_noise, s.relative_noise_rms), s.peak_memory_mib));
  if (options.keeps && !s.unkept.empty())
    throw WriteError(s.unkept + ": the picture is whole, but its samples are not kept");
}

void refuse_with_light_layers(const RenderCommandOptions& options, const PictureFiles& files,
                              const Scene& scene) {
  for (const auto& [name, is_given] :
       {std::pair{"--resume", options.resumes}, std::pair{"--keep", options.keeps},
        std::pair{"--fresh", options.starts_anew},
        std::pair{"--progressive", options.is_progressive},
        std::pair{"--cache", !options.cache.empty()}, std::pair{"--denoise", options.denoises},
        std::pair{"--prepare", options.only_prepares}})
    if (is_given) throw InvalidInput(std::string(name) + ": does not go with --light-layers");
  if (files.exr.empty())
    throw InvalidInput("--light-layers: the output must be an EXR, but is " + files.png);
  if (scene.render.noise > 0.0f)
    throw InvalidInput(fmt::format(
        "--noise: must be 0 with --light-layers, but is {:g}; where the scene file has it, "
        "--noise 0",
        scene.render.noise));
}

}  // namespace lamina::cli
