// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/render/render.h"
#include "lamina/scene/description/method_settings.h"
#include "lamina/scene/description/plausible_size.h"
#include "lamina/scene/description/scene.h"
#include "lamina/scene/description/subsurface_methods.h"
#include "picture_files.h"
#include "render_comparison.h"
#include "render_options.h"
#include "shard_option.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

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

/// "64,32,16,8": the left and the upper border, width and height [pixel].
PixelRectangle read_region(const std::string& text) {
  PixelRectangle region;
  std::array<int*, 4> numbers = {&region.x, &region.y, &region.width, &region.height};
  const char *at = text.data(), *const end = at + text.size();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const bool has_comma = i == 0 || (at != end && *at == ',');
    if (i > 0 && has_comma) ++at;
    const auto [next, error] = std::from_chars(at, end, *numbers[i]);
    at = next;
    if (!has_comma || error != std::errc() || (i == 3 && at != end))
      throw InvalidInput(
          "--region: must be X,Y,WIDTH,HEIGHT, whole numbers of pixels from the upper left "
          "corner, but is " +
          text);
  }
  return region;
}

/// What the command line asks for in place of the scene file; another method leaves out what it
/// does not honour of the file's settings, with a warning.
void apply(const RenderCommandOptions& options, Scene& scene) {
  const auto leave_out = [&] {
    const std::vector<std::string> left_out = leave_out_unhonoured(scene);
    warn(left_out);
    scene.warnings.insert(scene.warnings.end(), left_out.begin(), left_out.end());
  };
  if (const auto quality = find_enum_value<RenderSettings::Quality>(options.quality))
    set_quality(*quality, scene);
  if (options.samples > 0) scene.render.samples_per_pixel = options.samples;
  if (options.noise >= 0.0f) scene.render.noise = options.noise;
  if (options.clamp >= 0.0f) scene.render.clamp = options.clamp;
  if (options.max_bounces >= 0) scene.render.max_bounces = options.max_bounces;
  if (!options.method.empty()) scene.render.method = method_named("--method", options.method);
  if (!options.method.empty() || !options.quality.empty()) leave_out();
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
  if (options.look.exposure_given.is_given()) scene.film.exposure = options.look.exposure;
  if (const auto view = find_enum_value<View>(options.look.view)) scene.film.view = *view;
  if (options.has_alpha) make_background_transparent(scene);
  // One side alone keeps the proportions.
  const double aspect = static_cast<double>(scene.film.width) / scene.film.height;
  if (options.width > 0 && options.height == 0)
    scene.film.height = std::max(1, static_cast<int>(std::lround(options.width / aspect)));
  if (options.height > 0 && options.width == 0)
    scene.film.width = std::max(1, static_cast<int>(std::lround(options.height * aspect)));
  if (options.width > 0) scene.film.width = options.width;
  if (options.height > 0) scene.film.height = options.height;
  if (!options.region.empty()) scene.film.region = read_region(options.region);
  if (scene.film.region)
    require_inside(*scene.film.region, scene.film.width, scene.film.height,
                   options.region.empty() ? "film.region" : "--region");
}

void run_comparison(const RenderCommandOptions& options, const PictureFiles& files, Scene scene) {
  if (files.exr.empty() || files.png.empty())
    throw InvalidInput("--output " + options.output +
                       ": with --compare the name must have no ending, there are many files");
  for (const auto& [name, is_given] :
       {std::pair{"--method", !options.method.empty()},
        std::pair{"--cache", !options.cache.empty()},
        std::pair{"--cache-only", options.needs_cache},
        std::pair{"--foreign-light", options.takes_foreign_light},
        std::pair{"--resume", options.resumes}, std::pair{"--fresh", options.starts_anew},
        std::pair{"--keep", options.keeps}, std::pair{"--progressive", options.is_progressive},
        std::pair{"--cryptomatte", options.has_mattes}, std::pair{"--stamp", options.is_stamped},
        std::pair{"--light-layers", options.has_light_layers},
        std::pair{"--denoise", options.denoises}, std::pair{"--ocio", !options.look.ocio.empty()},
        std::pair{"--display", !options.look.display.empty()},
        std::pair{"--color-space", options.look.space != RgbSpace::rec709}})
    if (is_given) throw InvalidInput(std::string(name) + ": does not go with --compare");
  std::vector<NamedMethod> methods_to_compare;
  for (const std::string& name : options.compared)
    methods_to_compare.emplace_back(name, method_named("--compare", name));
  if (methods_to_compare.size() < 2)
    throw InvalidInput("--compare: must name two methods or more, as in probe,hierarchy");
  run_comparison(std::move(scene), methods_to_compare, fs::path(files.exr).replace_extension(),
                 options.common);
}

/// Makes what all shards share.
void run_preparation(const RenderCommandOptions& options, const Scene& scene) {
  const RenderResult result = render(scene,
                                     {.cache = options.cache,
                                      .memory = options.common.memory,
                                      .takes_foreign_light = options.takes_foreign_light,
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
  if (const auto quality = scene.render.quality) json["quality"] = name_of(*quality);
  json["width"] = scene.film.width;
  json["height"] = scene.film.height;
  json["samples_per_pixel"] = scene.render.samples_per_pixel;
  json["noise"] = scene.render.noise;
  if (const auto& region = scene.film.region)
    json["region"] = JsonOutput::array({region->x, region->y, region->width, region->height});
  json["files"] = files;
  write_json(json, options.common);
  print(
      options.common,
      fmt::format(
          "{}: {} x {} pixels, {} samples per pixel, method {}{}\n", fmt::join(files, ", "),
          scene.film.width, scene.film.height, scene.render.samples_per_pixel, method,
          scene.render.quality ? fmt::format(", quality {}", name_of(*scene.render.quality)) : ""));
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
  if (options.takes_foreign_light && options.cache.empty())
    throw InvalidInput("--foreign-light: goes with --cache, which is not given");
  const PictureLook look(options.look);
  if (options.watches) return watch_picture(options, files, look);
  const bool may_keep =
      !options.only_prepares && options.compared.empty() && !options.has_light_layers;
  const fs::path checkpoint = may_keep ? checkpoint_beside(options, is_shard            ? shard
                                                                    : files.exr.empty() ? files.png
                                                                                        : files.exr)
                                       : fs::path();
  Scene scene = load_scene_to_render(options);
  if (options.has_light_layers && !is_shard && options.compared.empty())
    refuse_with_light_layers(options, files, scene);
  if (!options.needs_cache && !options.takes_foreign_light) require_writable(options.cache);
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
    return render_shard(options, scene, shard, checkpoint);
  }
  if (!options.compared.empty()) return run_comparison(options, files, std::move(scene));

  render_picture(options, files, look, std::move(scene), checkpoint);
}

/// How good the picture is to be, and how long that may take.
void add_quality_options(const Command& command, RenderCommandOptions& options) {
  command
      .add_option("--quality", options.quality,
                  "how good: preview, a first look; final, with what errs little and has no noise "
                  "below surfaces; reference, with no error but noise. Chooses method, correction "
                  "and samples, in place of the scene's; --method, --correct and --samples stand "
                  "in place of its choice")
      .one_of(names_as_text<RenderSettings::Quality>());
  command.add_option("--samples", options.samples, "samples per pixel")
      .type_name("N")
      .range(1, 1 << 24);
  command
      .add_option("--noise", options.noise,
                  "ends where the standard error is below this fraction of the brightness, "
                  "0.01 for clean pictures; --samples is then the most that a pixel gets")
      .type_name("X")
      .range(0.0, 1.0);
  command.add_option("--bounces", options.max_bounces, "bounces of light between surfaces")
      .type_name("N")
      .range(0, 1000);
  command
      .add_option(
          "--clamp", options.clamp,
          "cuts the light of single samples to X per channel, against fireflies: the picture "
          "lacks what is cut")
      .type_name("X")
      .range(0.0, 1e6);
  command.add_flag("--denoise", options.denoises,
                   "averages over what looks alike within the noise: for viewing, not measuring. "
                   "The EXR keeps the noisy colors too");
}

/// The size of the picture and the layers that its file has.
void add_picture_options(const Command& command, RenderCommandOptions& options) {
  command.add_option("--width", options.width, "width in pixels; alone it keeps the proportions")
      .type_name("N")
      .range(1, 16384);
  command.add_option("--height", options.height, "height in pixels").type_name("N").range(1, 16384);
  command
      .add_option("--region", options.region,
                  "renders these pixels alone, from the upper left corner: they are those of the "
                  "whole picture. The EXR has them in their place (its data window), the PNG is of "
                  "their size")
      .type_name("X,Y,WIDTH,HEIGHT");
  command.add_flag("--alpha", options.has_alpha,
                   "channel A: how much of a pixel surfaces cover; the sky lights but is not seen");
  command.add_flag("--cryptomatte", options.has_mattes,
                   "mattes of objects and materials in the EXR, by Cryptomatte's conventions");
  command.add_flag("--light-layers", options.has_light_layers,
                   "layers light.NAME of each light in the EXR, whose sum is the picture; lights "
                   "that share a \"name\" in the scene share one. They are rendered one after the "
                   "other, each with all --samples");
  command.add_flag(
      "--stamp", options.is_stamped,
      "the EXR says the scene's file, the command, the date and the time it took, too");
}

/// Work in parts, work that goes on, and checks without work.
void add_work_options(const Command& command, RenderCommandOptions& options) {
  command.add_flag("--resume", options.resumes,
                   "goes on with a picture that was stopped or killed: the result is the same as "
                   "without. A file IMAGE.unfinished keeps what there is, every half minute. More "
                   "--samples than were wanted then add to it");
  command.add_flag("--fresh", options.starts_anew,
                   "starts anew in place of what IMAGE.unfinished keeps, which stays otherwise");
  command.add_flag("--keep", options.keeps,
                   "keeps IMAGE.unfinished of a finished picture, too: --resume with more "
                   "--samples, or less --noise, then adds to it, and without --noise makes the "
                   "picture of all samples at once, bit by bit. 248 bytes per pixel");
  command.add_flag("--progressive", options.is_progressive,
                   "writes the picture every few seconds while it grows, from the first sample of "
                   "all pixels on; each takes the place of the last as a whole");
  command.add_flag(
      "--watch", options.watches,
      "renders again when the scene changes or a file that it names, until Ctrl-C; a "
      "change ends the work on a picture that it makes out of date. What is wrong in a "
      "file is said, and waited for");
  command
      .add_option("--shard", options.shard,
                  "does part I of N of the samples of all pixels, for `lamina merge`, which makes "
                  "the same picture of all parts; --output is then X.shard")
      .type_name("I/N");
  command.add_flag("--prepare", options.only_prepares,
                   "makes no picture but what shards share: the light of --cache, and the profiles "
                   "that lamina keeps on disk");
  command.add_flag("--check", options.only_checks,
                   "reads the scene and says what would be rendered, without doing it");
}

/// Methods of light below surfaces, for those who know them, and the light that they keep.
void add_method_options(const Command& command, RenderCommandOptions& options) {
  command
      .add_option("--method", options.method,
                  "of light below surfaces: auto, one of the others by what the scene needs; " +
                      describe_methods())
      .type_name("NAME");
  command.add_flag("--correct", options.corrects,
                   "corrects the light of hierarchy and texture_space, which take the surface as "
                   "flat, by random walks");
  command
      .add_option("--profile", options.profile,
                  "model of the profile of light below surfaces: radiative_transfer, the default, "
                  "some seconds per material once, then on disk; diffusion, at once, for previews, "
                  "and the default beside --single-scattering; dipole, diffusion in a single layer")
      .one_of(names_as_text<RenderSettings::Profile>());
  command
      .add_option("--compare", options.compared,
                  "renders by each of these methods; writes IMAGE_METHOD.exr and .png, IMAGE.svg "
                  "with all side by side over their differences from the slowest, and a table")
      .type_name("NAME,NAME,...")
      .delimiter(',');
  command
      .add_option("--cache", options.cache,
                  "keeps the light that hierarchy samples, or that leaves at the texels of "
                  "texture_space: other cameras on the same scene read it instead. "
                  "PLY, a point per sample. Made anew where the light has changed or the file is "
                  "damaged")
      .type_name("FILE");
  command.add_flag("--cache-only", options.needs_cache,
                   "ends with what differs where the light of --cache would have to be made anew");
  command.add_flag(
      "--foreign-light", options.takes_foreign_light,
      "takes the light of --cache as it is, whoever made it and for whatever scene, and "
      "leaves the file alone");
}

/// Methods that are kept to compare with the papers' pictures.
void add_paper_options(const Command& command, RenderCommandOptions& options) {
  command
      .add_option(
          "--single-scattering", options.single_scattering,
          "adds light scattered once below the surface, which a profile by diffusion lacks: "
          "straight (to the light) or refracted (by Snell's law), as in [Hery2003]. Of the papers "
          "are also --method shadow_map, --profile dipole and, in scenes, exit_angle \"printed\", "
          "factors and scattering \"xu_sun\"")
      .one_of(names_as_text<RenderSettings::SingleScattering>())
      .group("Methods of the papers");
}

}  // namespace

void warn(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) say("warning: " + line);
}

Scene load_scene_to_render(const RenderCommandOptions& options) {
  Scene scene = [&] {
    const Progress loading = make_progress("loading the scene", Keeps::nothing);
    return load_scene(options.scene, options.common.memory, options.settings);
  }();
  prepare_to_render(options, scene);
  return scene;
}

void prepare_to_render(const RenderCommandOptions& options, Scene& scene) {
  std::ranges::move(implausible_sizes(scene), std::back_inserter(scene.warnings));
  warn(scene.warnings);
  apply(options, scene);
  if (!options.cache.empty() && !scene.render.method.is_open() && !scene.render.method->keeps_light)
    throw InvalidInput(fmt::format("--cache: the method must be {}, but is {}",
                                   methods_that_keep_light(), scene.render.method.name()));
}

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
  add_quality_options(command, *options);
  add_picture_options(command, *options);
  add_work_options(command, *options);
  add_method_options(command, *options);
  add_paper_options(command, *options);
  add_look_options(command, options->look);
  add_common_options(command, options->common);
  options->seed = command.option("--seed");
  command.footer(
      "What is not given is as the scene says. Ctrl-C keeps the image as far as it got.\n"
      "Example: lamina render scenes/sphere_skin.json -o sphere.png --samples 16 --width 256\n"
      "  a first look: lamina render scenes/sphere_skin.json -o look.png --quality preview\n"
      "  the same from near: lamina render scenes/sphere_skin.json -o near.png --set "
      "camera.horizontal_fov=20");
  command.callback([options] { run_render(*options); });
}

}  // namespace lamina::cli
