// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "lamina/core/error.h"
#include "lamina/image/denoise.h"
#include "lamina/image/image_file.h"
#include "lamina/image/tone.h"
#include "lamina/io/files_read.h"
#include "lamina/io/nearest_name.h"
#include "lamina/render/light_layers.h"
#include "lamina/render/render.h"
#include "lamina/scene/method_settings.h"
#include "lamina/scene/scene.h"
#include "lamina/scene/skin_totals.h"
#include "lamina/scene/subsurface_methods.h"
#include "picture_files.h"
#include "render_comparison.h"
#include "shard_option.h"
#include "watched_files.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

struct RenderCommandOptions {
  CommonOptions common;
  std::string scene, output, method, profile, cache, single_scattering, shard, view;
  int samples = 0, width = 0, height = 0, max_bounces = -1;
  float exposure = 0.0f, noise = -1.0f;
  bool needs_cache = false, resumes = false, keeps = false, is_progressive = false,
       has_alpha = false, has_mattes = false, has_light_layers = false, is_stamped = false,
       denoises = false, watches = false, corrects = false, only_prepares = false,
       only_checks = false;
  std::vector<std::string> compared, settings;
  Option seed, exposure_given;
};

/// Keeps an unfinished picture beside where the picture will be.
fs::path checkpoint_file(const PictureFiles& files) {
  fs::path file(files.exr.empty() ? files.png : files.exr);
  return file.replace_extension(".unfinished");
}

SceneMethod method_named(const std::string& option, const std::string& name) {
  const auto methods = subsurface_methods();
  if (const auto method = find_method(name, methods)) return *method;
  const std::vector<std::string_view> names = method_names(methods);
  throw InvalidInput(fmt::format("{}: must be one of {}, but is {}{}", option,
                                 fmt::join(names, ", "), name, did_you_mean(name, names)));
}

/// "hierarchy or texture_space".
std::string methods_that_keep_light() {
  std::vector<std::string_view> names;
  for (const SceneMethod method : subsurface_methods())
    if (method->keeps_light) names.push_back(method.name());
  return fmt::format("{}", fmt::join(names, " or "));
}

template <NamedEnum E>
std::vector<std::string> names_as_text() {
  const auto names = names_of<E>();
  return {names.begin(), names.end()};
}

void warn(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) say("warning: " + line);
}

/// What the command line asks for in place of the scene file; another method leaves out what it
/// does not honour of the file's settings, with a warning.
void apply(const RenderCommandOptions& options, Scene& scene) {
  if (options.samples > 0) scene.render.samples_per_pixel = options.samples;
  if (options.noise >= 0.0f) scene.render.noise = options.noise;
  if (options.max_bounces >= 0) scene.render.max_bounces = options.max_bounces;
  if (!options.method.empty()) {
    scene.render.method = method_named("--method", options.method);
    const std::vector<std::string> left_out = leave_out_unhonoured(scene);
    warn(left_out);
    scene.warnings.insert(scene.warnings.end(), left_out.begin(), left_out.end());
  }
  if (!options.single_scattering.empty()) {
    scene.places["render.single_scattering"] = "--single-scattering";
    scene.render.single_scattering =
        *find_enum_value<RenderSettings::SingleScattering>(options.single_scattering);
  }
  if (options.corrects) {
    scene.places["render.correct"] = "--correct";
    scene.render.is_corrected = true;
  }
  if (!options.profile.empty()) {
    scene.places["render.profile"] = "--profile";
    scene.render.profile = find_enum_value<RenderSettings::Profile>(options.profile);
  }
  if (options.seed.is_given()) scene.render.seed = options.common.seed;
  if (options.exposure_given.is_given()) scene.film.exposure = options.exposure;
  if (!options.view.empty()) scene.film.view = *find_enum_value<View>(options.view);
  if (options.has_alpha) make_background_transparent(scene);
  // One side alone keeps the proportions.
  const double aspect = static_cast<double>(scene.film.width) / scene.film.height;
  if (options.width > 0 && options.height == 0)
    scene.film.height = std::max(1, static_cast<int>(std::lround(options.width / aspect)));
  if (options.height > 0 && options.width == 0)
    scene.film.width = std::max(1, static_cast<int>(std::lround(options.height * aspect)));
  if (options.width > 0) scene.film.width = options.width;
  if (options.height > 0) scene.film.height = options.height;
}

void run_comparison(const RenderCommandOptions& options, const PictureFiles& files, Scene scene) {
  if (files.exr.empty() || files.png.empty())
    throw InvalidInput("--output " + options.output +
                       ": with --compare the name must have no ending, there are many files");
  for (const auto& [name, is_given] :
       {std::pair{"--method", !options.method.empty()},
        std::pair{"--cache", !options.cache.empty()},
        std::pair{"--cache-only", options.needs_cache}, std::pair{"--resume", options.resumes},
        std::pair{"--keep", options.keeps}, std::pair{"--progressive", options.is_progressive},
        std::pair{"--cryptomatte", options.has_mattes}, std::pair{"--stamp", options.is_stamped},
        std::pair{"--light-layers", options.has_light_layers},
        std::pair{"--denoise", options.denoises}})
    if (is_given) throw InvalidInput(std::string(name) + ": does not go with --compare");
  std::vector<NamedMethod> methods_to_compare;
  for (const std::string& name : options.compared)
    methods_to_compare.emplace_back(name, method_named("--compare", name));
  if (methods_to_compare.size() < 2)
    throw InvalidInput("--compare: must name two methods or more, as in probe,hierarchy");
  run_comparison(std::move(scene), methods_to_compare, fs::path(files.exr).replace_extension(),
                 options.common);
}

/// Where the part of --shard goes: beside where the picture would be without the option.
fs::path shard_file(const RenderCommandOptions& options, const Shard& shard) {
  if (lower_case_ending(options.output) == ".shard") return options.output;
  std::error_code ignored;
  if (!options.output.empty() && !fs::is_directory(options.output, ignored))
    throw InvalidInput("--output: must end in .shard with --shard, but is " + options.output);
  if (options.scene == "-")
    throw InvalidInput("--output: must name the shard of what standard input describes");
  return fs::path(options.output) / fmt::format("{}.{}-of-{}.shard",
                                                fs::path(options.scene).stem().string(),
                                                shard.index, shard.count);
}

/// The options that a part of the samples cannot have.
void refuse_with_shard(const RenderCommandOptions& options, const Scene& scene) {
  for (const auto& [name, is_given] :
       {std::pair{"--keep", options.keeps}, std::pair{"--progressive", options.is_progressive},
        std::pair{"--cryptomatte", options.has_mattes},
        std::pair{"--light-layers", options.has_light_layers},
        std::pair{"--stamp", options.is_stamped}})
    if (is_given) throw InvalidInput(std::string(name) + ": does not go with --shard");
  if (options.denoises)
    throw InvalidInput("--denoise: is for `lamina merge`, which has all samples, not for --shard");
  if (options.noise > 0.0f || scene.render.noise > 0.0f)
    throw InvalidInput(
        "--noise: does not go with --shard, which does not know the noise of the others; `lamina "
        "merge --noise` tells it. Where the scene file has it, --noise 0");
}

/// The options that pictures made light by light cannot have.
void refuse_with_light_layers(const RenderCommandOptions& options, const PictureFiles& files,
                              const Scene& scene) {
  for (const auto& [name, is_given] :
       {std::pair{"--resume", options.resumes}, std::pair{"--keep", options.keeps},
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

/// Makes what all shards share.
void run_preparation(const RenderCommandOptions& options, const Scene& scene) {
  const RenderResult result = render(scene,
                                     {.cache = options.cache,
                                      .memory = options.common.memory,
                                      .only_prepares = true,
                                      .on_notice = say},
                                     make_progress("preparing", Keeps::nothing));
  if (!result.statistics.is_complete) throw Interrupted();
  JsonOutput json = make_result("render");
  json["method"] = std::string(result.statistics.method.name());
  json["cpu_seconds"] = result.statistics.cpu_seconds;
  write_json(json, options.common);
  print(options.common,
        fmt::format("prepared{}: {:.1f} s CPU\n", options.cache.empty() ? "" : " " + options.cache,
                    result.statistics.cpu_seconds));
}

/// Says what would be rendered.
void print_check(const RenderCommandOptions& options, const Scene& scene,
                 const std::vector<std::string>& files) {
  const std::string method =
      scene.render.method.is_open() ? "auto" : std::string(scene.render.method.name());
  JsonOutput json = make_result("render");
  json["method"] = method;
  json["width"] = scene.film.width;
  json["height"] = scene.film.height;
  json["samples_per_pixel"] = scene.render.samples_per_pixel;
  json["noise"] = scene.render.noise;
  json["files"] = files;
  write_json(json, options.common);
  print(options.common,
        fmt::format("{}: {} x {} pixels, {} samples per pixel, method {}\n", fmt::join(files, ", "),
                    scene.film.width, scene.film.height, scene.render.samples_per_pixel, method));
}

/// Renders the part of --shard.
void run_shard(const RenderCommandOptions& options, const Scene& scene, const fs::path& file) {
  const fs::path checkpoint = fs::path(file).replace_extension(".unfinished");
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

/// Writes a picture. @return  the names of its files
std::string write_picture(const Image& image, const Film& film, const PictureFiles& files,
                          const std::vector<ImageNote>& notes) {
  std::string written;
  if (!files.exr.empty()) {
    save_exr(image, files.exr, ExrPrecision::half, notes);
    written += files.exr;
  }
  if (!files.png.empty()) {
    save_png(view_image(unpremultiplied(image), film.view, static_cast<double>(film.exposure)),
             files.png);
    written += (written.empty() ? "" : ", ") + files.png;
  }
  return written;
}

/// Writes pictures as they grow. One that cannot be written is said once: the last may fit again.
std::function<void(const Image&)> make_writer(const Film& film, const PictureFiles& files) {
  return [&film, &files, has_failed = false](const Image& image) mutable {
    try {
      (void)write_picture(image, film, files, {});
    } catch (const WriteError& error) {
      if (!has_failed) say(std::string("warning: ") + error.what());
      has_failed = true;
    }
  };
}

/// The scene as it is to be rendered.
Scene load(const RenderCommandOptions& options) {
  Scene scene = [&] {
    const Progress loading = make_progress("loading the scene", Keeps::nothing);
    return load_scene(options.scene, options.common.memory, options.settings);
  }();
  warn(scene.warnings);
  apply(options, scene);
  if (!options.cache.empty() && !scene.render.method.is_open() && !scene.render.method->keeps_light)
    throw InvalidInput(fmt::format("--cache: the method must be {}, but is {}",
                                   methods_that_keep_light(), scene.render.method.name()));
  return scene;
}

/// Work that ends where what it is made from has changed.
/// @param has_changed  may be empty
Progress until_changed(Progress progress, const std::function<bool()>& has_changed) {
  if (!has_changed) return progress;
  return [progress = std::move(progress), has_changed](double finished) {
    return progress(finished) && !has_changed();
  };
}

/// Renders and writes the picture.
/// @param has_changed  whether what it is made from has: the work then ends without a picture.
/// Empty
///                     where that is not asked for
void make_picture(const RenderCommandOptions& options, const PictureFiles& files, Scene scene,
                  const std::function<bool()>& has_changed) {
  const fs::path checkpoint = checkpoint_file(files);
  const auto say_how_to_go_on = [&] {
    if (fs::exists(checkpoint))
      say("stopped early; the same command with --resume goes on from " + checkpoint.string());
  };
  RenderResult result;
  try {
    const RenderOptions how{
        .cache = options.cache,
        .memory = options.common.memory,
        .needs_cache = options.needs_cache,
        .checkpoint = has_changed ? fs::path() : checkpoint,
        .resumes = options.resumes,
        .keeps_samples = options.keeps,
        .has_mattes = options.has_mattes,
        .on_notice = say,
        .on_image = options.is_progressive ? make_writer(scene.film, files) : nullptr};
    const Progress progress =
        until_changed(make_progress("rendering", options.has_light_layers ? Keeps::nothing
                                                                          : Keeps::what_there_is),
                      has_changed);
    result = options.has_light_layers ? render_light_layers(scene, how, progress)
                                      : render(scene, how, progress);
  } catch (const Interrupted&) {
    if (has_changed && !was_interrupted()) return;
    say_how_to_go_on();
    throw;
  }
  if (has_changed && !result.statistics.is_complete && !was_interrupted()) return;
  if (options.keeps && result.statistics.is_complete && !fs::exists(checkpoint))
    say("warning: " + checkpoint.string() + " cannot be written: the samples are not kept");
  if (options.denoises) {
    const Progress denoising = make_progress("denoising");
    result.image = denoise(result.image);
  }
  std::vector<ImageNote> notes = std::move(result.notes);
  notes.push_back({"lamina/version", LAMINA_VERSION});
  if (options.is_stamped)
    std::ranges::move(stamp(options, result.statistics), std::back_inserter(notes));
  const std::string written = write_picture(result.image, scene.film, files, notes);

  const RenderStatistics& s = result.statistics;
  for (const std::string& warning : s.warnings) say("warning: " + warning);
  if (!s.is_complete) say_how_to_go_on();
  std::string sampled;
  for (const LightSamples& light : s.light_samples)
    sampled +=
        fmt::format("{}: {} samples of the light, {:.3g} mm apart{}\n",
                    scene.materials[light.material].name, light.count, light.spacing,
                    light.change ? fmt::format("; twice as far apart the light differs by {:.2g} %",
                                               100.0 * *light.change)
                                 : "");
  for (const LightCorrection& correction : s.corrections)
    sampled += fmt::format(
        "{}: light corrected by {:.2g} million random walks, {:.2g} % of it; about {:.2g} % of "
        "error left\n",
        scene.materials[correction.material].name, 1e-6 * static_cast<double>(correction.walks),
        100.0 * correction.change, 100.0 * correction.error_left);
  scene.render.method = s.method;  // where it was left open
  std::string skins;
  for (const SkinTotals& totals : skin_totals(scene))
    skins += describe_skin_totals(totals, scene) + "\n";
  const std::string noise =
      s.relative_noise ? fmt::format("{:.2f} % noise, ", 100.0 * *s.relative_noise) : "";
  JsonOutput json = make_result("render");
  json["method"] = std::string(s.method.name());
  if (!s.why_method.empty()) json["method_chosen_because"] = s.why_method;
  json["expected_cpu_seconds"] = s.expected_cpu_seconds;
  json["expected_memory_mib"] = s.expected_memory_mib;
  json["wall_seconds"] = s.wall_seconds;
  json["cpu_seconds"] = s.cpu_seconds;
  json["samples_per_pixel"] = s.samples_per_pixel;
  if (s.relative_noise) json["relative_noise"] = *s.relative_noise;
  json["peak_memory_mib"] = s.peak_memory_mib;
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
                                   {"error_left", correction.error_left}});
  for (const ProfileUse& use : s.profiles)
    json["profiles"].push_back(
        {{"material", scene.materials[use.material].name}, {"profile", name_of(use.source)}});
  if (options.has_light_layers)
    for (const LightGroup& group : light_groups(scene)) json["light_layers"].push_back(group.name);
  json["width"] = scene.film.width;
  json["height"] = scene.film.height;
  json["is_complete"] = s.is_complete;
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
  json["warnings"] = scene.warnings;
  for (const std::string& warning : s.warnings) json["warnings"].push_back(warning);
  write_json(json, options.common);
  print(
      options.common,
      fmt::format("{}{}\n{}{}{:.1f} s wall, {:.1f} s CPU, {:.4g} samples per pixel, {}{:.0f} MiB\n",
                  s.is_complete ? "" : "stopped early: ", written, skins, sampled, s.wall_seconds,
                  s.cpu_seconds, s.samples_per_pixel, noise, s.peak_memory_mib));
}

/// The options that do not go with pictures made again and again.
void refuse_with_watch(const RenderCommandOptions& options) {
  for (const auto& [name, is_given] :
       {std::pair{"--resume", options.resumes}, std::pair{"--keep", options.keeps},
        std::pair{"--shard", !options.shard.empty()}, std::pair{"--prepare", options.only_prepares},
        std::pair{"--check", options.only_checks},
        std::pair{"--compare", !options.compared.empty()}})
    if (is_given) throw InvalidInput(std::string(name) + ": does not go with --watch");
  std::error_code ignored;
  if (!fs::exists(options.scene, ignored) && options.scene != "-")
    throw FileError(options.scene + ": there is no such file");
  if (!fs::is_regular_file(options.scene, ignored))
    throw InvalidInput("--watch: the scene must be a file, but is " + options.scene);
}

/// Renders again whenever one of the files changes that loading the scene has read or looked for.
void run_watch(const RenderCommandOptions& options, const PictureFiles& files) {
  refuse_with_watch(options);
  while (true) {
    FilesRead reading;
    std::optional<WatchedFiles> watched;
    try {
      Scene scene = load(options);
      if (options.has_light_layers) refuse_with_light_layers(options, files, scene);
      watched.emplace(reading.files());
      make_picture(options, files, std::move(scene), [&] { return watched->has_changed(); });
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

void run_render(const RenderCommandOptions& options) {
  const bool is_shard = !options.shard.empty();
  const std::string shard = is_shard ? shard_file(options, read_shard(options.shard)).string() : "";
  require_writable(shard);
  const PictureFiles files = is_shard || options.only_prepares
                                 ? PictureFiles()
                                 : picture_files(options.output, options.scene);
  require_different({{"--output", shard},
                     {"--output", files.exr},
                     {"--output", files.png},
                     {"--json", options.common.json},
                     {"--cache", options.cache},
                     {"the scene", options.scene}});
  if (options.needs_cache && options.cache.empty())
    throw InvalidInput("--cache-only: goes with --cache, which is not given");
  if (options.watches) return run_watch(options, files);
  Scene scene = load(options);
  if (options.has_light_layers && !is_shard && options.compared.empty())
    refuse_with_light_layers(options, files, scene);
  if (!options.needs_cache) require_writable(options.cache);
  if (options.only_checks) {
    if (is_shard) refuse_with_shard(options, scene);
    std::vector<std::string> written;
    for (const std::string& file : {shard, files.exr, files.png})
      if (!file.empty()) written.push_back(file);
    return print_check(options, scene, written);
  }
  if (options.only_prepares) return run_preparation(options, scene);
  if (is_shard) {
    if (!options.compared.empty()) throw InvalidInput("--compare: does not go with --shard");
    refuse_with_shard(options, scene);
    return run_shard(options, scene, shard);
  }
  if (!options.compared.empty()) return run_comparison(options, files, std::move(scene));

  make_picture(options, files, std::move(scene), {});
}

}  // namespace

void add_render_command(CLI::App& app) {
  auto options = std::make_shared<RenderCommandOptions>();
  const Command command(app, "render", "Renders a scene to an image.");
  command.add_option("scene", options->scene, "scene file").type_name("SCENE").required();
  add_settings_option(command, options->settings, "scene");
  command
      .add_option("-o,--output", options->output,
                  "IMAGE.exr: all channels, linear; IMAGE.png: as it looks; without an ending, or "
                  "with a frame number for one, both; in a folder, or without the option, both "
                  "named after the scene")
      .type_name("IMAGE");
  command.add_option("--samples", options->samples, "samples per pixel")
      .type_name("N")
      .range(1, 1 << 24);
  command
      .add_option("--noise", options->noise,
                  "ends where the standard error is below this fraction of the brightness, "
                  "0.01 for clean pictures; --samples is then the most that a pixel gets")
      .type_name("X")
      .range(0.0, 1.0);
  command.add_flag("--resume", options->resumes,
                   "goes on with a picture that was stopped or killed: the result is the same as "
                   "without. A file IMAGE.unfinished keeps what there is, every half minute. More "
                   "--samples than were wanted then add to it");
  command.add_flag("--keep", options->keeps,
                   "keeps IMAGE.unfinished of a finished picture, too: --resume with more "
                   "--samples, or less --noise, then adds to it, and without --noise makes the "
                   "picture of all samples at once, bit by bit. 248 bytes per pixel");
  command.add_flag("--progressive", options->is_progressive,
                   "writes the picture every few seconds while it grows, from the first sample of "
                   "all pixels on; each takes the place of the last as a whole");
  command.add_flag(
      "--watch", options->watches,
      "renders again when the scene changes or a file that it names, until Ctrl-C; a "
      "change ends the work on a picture that it makes out of date. What is wrong in a "
      "file is said, and waited for");
  command
      .add_option("--shard", options->shard,
                  "does part I of N of the samples of all pixels, for `lamina merge`, which makes "
                  "the same picture of all parts; --output is then X.shard")
      .type_name("I/N");
  command.add_flag("--prepare", options->only_prepares,
                   "makes no picture but what shards share: the light of --cache, and the profiles "
                   "that lamina keeps on disk");
  command.add_flag("--check", options->only_checks,
                   "reads the scene and says what would be rendered, without doing it");
  command.add_option("--width", options->width, "width in pixels; alone it keeps the proportions")
      .type_name("N")
      .range(1, 16384);
  command.add_option("--height", options->height, "height in pixels")
      .type_name("N")
      .range(1, 16384);
  command.add_option("--bounces", options->max_bounces, "bounces of light between surfaces")
      .type_name("N")
      .range(0, 1000);
  command
      .add_option(
          "--method", options->method,
          "of light below surfaces: auto, one of the others by what the scene needs and what "
          "it costs; " +
              describe_methods(subsurface_methods()))
      .type_name("NAME");
  command
      .add_option("--compare", options->compared,
                  "renders by each of these methods; writes IMAGE_METHOD.exr and .png, IMAGE.svg "
                  "with all side by side over their differences from the slowest, and a table")
      .type_name("NAME,NAME,...")
      .delimiter(',');
  command.add_flag("--denoise", options->denoises,
                   "averages over what looks alike within the noise: for viewing, not measuring. "
                   "The EXR keeps the noisy colors too");
  command
      .add_option(
          "--single-scattering", options->single_scattering,
          "adds light scattered once below the surface: straight (to the light) or refracted "
          "(by Snell's law)")
      .one_of(names_as_text<RenderSettings::SingleScattering>());
  command.add_flag("--correct", options->corrects,
                   "corrects the light of hierarchy and texture_space, which take the surface as "
                   "flat, by random walks");
  command
      .add_option("--cache", options->cache,
                  "keeps the light that hierarchy samples, or that leaves at the texels of "
                  "texture_space: other cameras on the same scene read it instead. "
                  "PLY, a point per sample. Made anew where the light has changed or the file is "
                  "damaged")
      .type_name("FILE");
  command.add_flag("--cache-only", options->needs_cache,
                   "ends with what differs where the light of --cache would have to be made anew");
  command
      .add_option("--profile", options->profile,
                  "model of the profile of light below surfaces: radiative_transfer, the default, "
                  "some seconds per material once, then on disk; diffusion, at once, for previews, "
                  "and the default beside --single-scattering; dipole, diffusion in a single layer")
      .one_of(names_as_text<RenderSettings::Profile>());
  options->exposure_given =
      command.add_option("--exposure", options->exposure, "stops, for the PNG only")
          .type_name("EV")
          .range(-50.0, 50.0);
  command
      .add_option("--view", options->view,
                  "how the PNG is seen: filmic, which rolls highlights off; agx, softer, bright "
                  "colors lose saturation; standard, cut off")
      .one_of(names_as_text<View>());
  command.add_flag("--alpha", options->has_alpha,
                   "channel A: how much of a pixel surfaces cover; the sky lights but is not seen");
  command.add_flag("--cryptomatte", options->has_mattes,
                   "mattes of objects and materials in the EXR, by Cryptomatte's conventions");
  command.add_flag("--light-layers", options->has_light_layers,
                   "layers light.NAME of each light in the EXR, whose sum is the picture; lights "
                   "that share a \"name\" in the scene share one. They are rendered one after the "
                   "other, each with all --samples");
  command.add_flag(
      "--stamp", options->is_stamped,
      "the EXR says the scene's file, the command, the date and the time it took, too");
  add_common_options(command, options->common);
  options->seed = command.option("--seed");
  command.footer(
      "What is not given is as the scene says. Ctrl-C keeps the image as far as it got.\n"
      "Example: lamina render scenes/sphere_skin.json -o sphere.png --samples 16 --width 256\n"
      "  the same from near: lamina render scenes/sphere_skin.json -o near.png --set "
      "camera.horizontal_fov=20");
  command.callback([options] { run_render(*options); });
}

}  // namespace lamina::cli
