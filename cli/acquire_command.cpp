// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <array>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquire_leaf.h"
#include "acquire_page.h"
#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/hash.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_input.h"
#include "lamina/base/plot/html_page.h"
#include "lamina/skin/acquire/files/acquired_files.h"
#include "lamina/skin/acquire/files/capture_file.h"
#include "lamina/skin/acquire/files/leaf_files.h"
#include "lamina/skin/acquire/skin_acquisition.h"
#include "picture_files.h"
#include "shard_option.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

struct AcquireOptions {
  CommonOptions common;
  std::string capture, output;
  std::vector<std::string> settings;
  LateralLight lateral = LateralLight::automatic;
  double most_forwards = InversionOptions{}.most_forwards, model_error = 0.0, robust_limit = 0.0;
  bool resumes = false, only_prepares = false, only_checks = false;
  std::string tiles, shard;
  std::size_t tile_memory = std::size_t{1} << 30;
  std::vector<std::pair<std::string, Option>> of_transport;  ///< those above, by name
};

/// Maps that an earlier call left in the folder.
std::vector<Image> maps_to_go_on_from(const Capture& capture, const fs::path& folder) {
  std::vector<Image> maps;
  for (const SkinFitNumber& number : capture.numbers) {
    const fs::path file = folder / (number.parameter.name + ".exr");
    Image map = load_image(file, ColorEncoding::linear);
    if (map.width != capture.reflectance.width || map.height != capture.reflectance.height)
      throw InvalidInput("--resume: " + file.string() + " must be of the size of the capture, " +
                         std::to_string(capture.reflectance.width) + " x " +
                         std::to_string(capture.reflectance.height) + ", but is " +
                         std::to_string(map.width) + " x " + std::to_string(map.height));
    require_finite(map, file);
    maps.push_back(std::move(map));
  }
  return maps;
}

constexpr const char* result_file = "result.json";

/// The smoothness that an earlier call chose; empty where it says none.
std::vector<double> smoothness_of(const fs::path& file, std::size_t numbers) {
  if (!fs::exists(file)) return {};
  const JsonDocument document = load_json(file);
  const auto given = document.root().peek("smoothness");
  if (!given || given->array().size() != 2 * numbers) return {};
  return given->numbers(2 * numbers, at_least(0.0));
}

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// @param said  how many of the last notes were said already
std::string text_of(const Capture& capture, const AcquiredSkin& skin, const AcquisitionCheck& check,
                    std::size_t said) {
  std::string text = pixels_text(capture, skin);
  text += fmt::format("\n{:<22} {:>9} {:>9} {:>9} {:>8}  {}\n", "", "median", "5 %", "95 %",
                      "error", "of the prior's error");
  for (const NumberSummary& each : summaries_of(skin))
    text +=
        fmt::format("{:<22} {:>9.4g} {:>9.4g} {:>9.4g} {:>8}  {:.2f}, {}\n", each.name, each.median,
                    each.low, each.high, deviation_text(each.deviation, each.is_relative),
                    each.prior_share, told_text(each));
  text += "what the maps reflect differs from the capture by";
  for (std::size_t b = 0; b < check.residual.size(); ++b)
    text +=
        fmt::format(" {:.1f} % ({})", 100.0 * check.residual[b], capture.reflectance.channels[b]);
  if (check.mean_difference) text += fmt::format(", CIEDE2000 {:.2f}", *check.mean_difference);
  if (!skin.chi_squared.empty()) text += "\n" + chi_squared_text(capture, skin);
  if (skin.inversion && !skin.inversion->history.empty()) {
    const InversionStep& last = skin.inversion->history.back();
    text += fmt::format(
        "\n{}; residual {:.2f} % of the mean, {:.2f} of its noise, after {:.0f} "
        "forward models",
        name_of(skin.inversion->stop), 100.0 * last.residual, last.in_deviations, last.forwards);
  }
  for (std::size_t i = 0; i + said < capture.notes.size(); ++i)
    text += "\nnote: " + capture.notes[i];
  return text + "\n";
}

std::string notes_text(const Capture& capture) {
  std::string text;
  for (const std::string& note : capture.notes) text += "note: " + note + "\n";
  return text;
}

JsonOutput json_of(const Capture& capture, const AcquiredSkin& skin, const AcquisitionCheck& check,
                   const AcquiredFiles& files) {
  JsonOutput json = make_result("acquire");
  json["width"] = skin.width;
  json["height"] = skin.height;
  json["lateral"] = skin.inversion && skin.inversion->has_transport ? "transport" : "none";
  if (skin.inversion) {
    json["stop"] = name_of(skin.inversion->stop);
    json["smoothness"] = skin.inversion->smoothness;
    for (const InversionStep& step : skin.inversion->history)
      json["history"].push_back({{"forwards", step.forwards},
                                 {"residual", step.residual},
                                 {"in_deviations", step.in_deviations}});
  }
  json["bands"] = capture.reflectance.channels;
  json["pixels"] = {{"skin", skin.counts[0]},
                    {"not_skin", skin.counts[2]},
                    {"too_dark", skin.sides[0]},
                    {"too_bright", skin.sides[1]},
                    {"of_another_color", skin.sides[2]}};
  const MaskCounts counts = count_pixels(capture.mask);
  for (std::size_t f = 0; f < counts.faults.size(); ++f)
    json["pixels"][enum_names<PixelFault>[f].name] = counts.faults[f];
  json["notes"] = capture.notes;
  const std::vector<NumberSummary> summaries = summaries_of(skin);
  for (std::size_t n = 0; n < summaries.size(); ++n) {
    const NumberSummary& each = summaries[n];
    JsonOutput by_band;
    for (std::size_t b = 0; b < check.by_calibration.rows; ++b)
      by_band[capture.reflectance.channels[b]] = check.by_calibration(b, n);
    json["numbers"].push_back({{"name", each.name},
                               {"file", files.maps[n].string()},
                               {"standard_deviation_file", files.deviations[n].string()},
                               {"median", each.median},
                               {"percentile_5", each.low},
                               {"percentile_95", each.high},
                               {"standard_deviation", each.deviation},
                               {"prior_share", each.prior_share},
                               {"within_share", each.within_share},
                               {"told", told_text(each)},
                               {"change_by_2_percent", by_band}});
  }
  json["residual"] = check.residual;
  json["chi_squared"] = skin.chi_squared;
  json["error_growth"] = skin.error_growth;
  if (check.mean_difference) json["mean_ciede2000"] = *check.mean_difference;
  json["mask"] = files.mask.string();
  json["material"] = files.material.string();
  if (!files.patch.empty()) {
    json["patch"] = files.patch.string();
    json["scene"] = files.scene.string();
  }
  return json;
}

/// Nothing that a user asks for is passed over in silence.
void refuse_options_of_transport(const AcquireOptions& options, const std::string& why) {
  for (const auto& [name, option] : options.of_transport)
    if (option.is_given()) throw InvalidInput(name + ": is not read " + why);
}

/// Each pixel of a leaf on its own.
void run_leaf(const AcquireOptions& options, Capture& capture, const fs::path& folder) {
  refuse_options_of_transport(options, "for a leaf, whose pixels are solved each by itself");
  if (options.lateral == LateralLight::transport)
    throw InvalidInput("--lateral: pixels of a leaf are solved each by itself");
  const LeafMaps leaf = acquire_leaf(capture, make_progress("acquiring", Keeps::nothing));
  for (std::string& note : notes_of_misfit(capture, leaf)) capture.notes.push_back(std::move(note));
  const LeafFiles files = save_leaf(leaf, capture, folder, LAMINA_VERSION);
  std::vector<std::string> arguments = {"acquire", options.capture, "-o", folder.string()};
  for (const std::string& setting : options.settings)
    arguments.insert(arguments.end(), {"--set", setting});
  const fs::path page = folder / "report.html";
  write_file(page.string(), leaf_page(leaf, capture, lamina_command_line(arguments)));
  JsonOutput json = make_result("acquire");
  add_leaf_json(leaf, capture, files, json);
  json["report"] = page.string();
  write_file((folder / result_file).string(), json.text(1) + "\n");
  write_json(json, options.common);
  print(options.common, leaf_text(leaf) + notes_text(capture) +
                            fmt::format("{}, {}\n", files.material.string(), page.string()));
}

/// A number that the tiles of a capture follow from.
std::uint64_t key_of_tiles(const AcquireOptions& options, const Capture& capture) {
  constexpr std::array<std::string_view, 1> of_tiles = {"--tiles"};
  constexpr std::array<std::string_view, 2> flags = {"--prepare", "--check"};
  Hash hash;
  hash.add_text(LAMINA_VERSION);
  for (const std::string& word : without_options(words_of_shards(words_of_call()), of_tiles, flags))
    hash.add_text(word);
  MemoryBudget memory = options.common.memory;
  if (options.capture != "-" && !is_device(options.capture))
    hash.add_text(read_file_bytes(options.capture, memory));
  hash.add_bytes(std::as_bytes(std::span(capture.reflectance.pixels)));
  hash.add_bytes(std::as_bytes(std::span(capture.deviation.pixels)));
  hash.add_bytes(std::as_bytes(std::span(capture.mask.faults)));
  for (const Image& light : capture.lights) hash.add_bytes(std::as_bytes(std::span(light.pixels)));
  hash.add(capture.sensor.values);
  if (capture.population)
    for (const auto& prior : capture.population->priors) {
      hash.add(prior.mean);
      hash.add(prior.standard_deviation);
    }
  return hash.value();
}

/// @throws InvalidInput for options that do not go together
void require_tiles(const AcquireOptions& options, std::size_t count) {
  const bool wants_part = options.only_prepares || !options.shard.empty();
  const char* name = options.only_prepares ? "--prepare" : "--shard";
  if (wants_part && options.tiles.empty())
    throw InvalidInput(fmt::format("{}: needs --tiles FOLDER, which all machines see", name));
  if (options.tiles.empty()) return;
  if (options.resumes)
    throw InvalidInput(
        "--resume: does not go with --tiles, which goes on with those that are there");
  if (count == 1)
    throw InvalidInput(fmt::format(
        "--tiles: must be of a capture that takes more than {} MiB, which --tile-memory "
        "says, but this one is solved as a whole",
        options.tile_memory >> 20));
}

/// Some tiles, or the first: no maps yet.
void acquire_tiles(const AcquireOptions& options, const Capture& capture,
                   const PatchAcquisitionOptions& patch) {
  const AcquiredSkin skin =
      acquire_patch(capture, patch, user_cache(), make_progress("acquiring", Keeps::what_there_is));
  if (skin.inversion->stop == InversionStop::interrupted) throw Interrupted();
  JsonOutput json = make_result("acquire");
  json["tiles"] = options.tiles;
  write_json(json, options.common);
  print(options.common, fmt::format("{}\n", options.tiles));
}

void print_tiles(const AcquireOptions& options, std::size_t count, const fs::path& folder) {
  JsonOutput json = make_result("acquire");
  json["tiles"] = count;
  json["output"] = folder.string();
  write_json(json, options.common);
  print(options.common, fmt::format("{} tiles\n", count));
}

void run_acquire(const AcquireOptions& options) {
  for (const char* ending : {".exr", ".png", ".json"})
    if (lower_case_ending(options.output) == ending)
      throw InvalidInput("--output: must be a folder, not a file, but is " + options.output);
  Capture capture =
      develop_capture(load_capture(options.capture, options.common.memory, options.settings));
  const fs::path folder =
      options.output.empty() ? named_after(options.capture, "folder") : options.output;
  require_writable_folder(folder);
  if (capture.leaf && options.only_checks) return print_tiles(options, 1, folder);
  if (capture.leaf) {
    run_leaf(options, capture, folder);
    return;
  }
  const AcquisitionPlan plan = plan_acquisition(capture, options.lateral);
  if (plan.has_table)
    refuse_options_of_transport(options, "where a table has the fits of all colors");
  PatchAcquisitionOptions patch;
  patch.inversion.most_forwards = options.most_forwards;
  patch.inversion.model_error = options.model_error;
  patch.inversion.robust_limit = options.robust_limit;
  patch.inversion.seed = options.common.seed;
  patch.has_transport = plan.has_transport;
  patch.most_bytes = static_cast<double>(options.tile_memory);
  const std::size_t tiles = plan.has_table ? 1 : count_tiles(capture, patch);
  if (options.only_checks) return print_tiles(options, tiles, folder);
  require_tiles(options, tiles);
  if (!options.tiles.empty()) {
    patch.kept = {.folder = options.tiles,
                  .key = key_of_tiles(options, capture),
                  .only_first = options.only_prepares};
    if (!options.shard.empty()) patch.kept->shard = read_shard(options.shard);
    if (options.only_prepares || patch.kept->shard) return acquire_tiles(options, capture, patch);
  }
  if (options.resumes) {
    patch.start = maps_to_go_on_from(capture, folder);
    patch.inversion.smoothness = smoothness_of(folder / result_file, capture.numbers.size());
  }
  const double start = seconds();
  const auto [skin, check, notes] = acquire_skin(
      capture, plan, std::move(patch), user_cache(),
      make_progress("acquiring", plan.has_table ? Keeps::nothing : Keeps::what_there_is));
  if (skin.inversion && skin.inversion->stop == InversionStop::interrupted)
    capture.notes.emplace_back(
        "stopped before errors were known, which are given as those of the prior; --resume goes "
        "on");
  const double solved = seconds() - start;
  for (const std::string& note : notes) say("warning: " + note);
  const std::size_t said = notes.size();
  capture.notes.insert(capture.notes.end(), notes.begin(), notes.end());
  const AcquiredFiles files = save_acquired(skin, capture, folder, LAMINA_VERSION);
  const fs::path page = folder / "report.html";
  std::vector<std::string> arguments = {"acquire",   options.capture,
                                        "-o",        folder.string(),
                                        "--lateral", plan.has_transport ? "transport" : "none"};
  for (const std::string& setting : options.settings)
    arguments.insert(arguments.end(), {"--set", setting});
  MemoryBudget memory = options.common.memory;
  write_file(page.string(), acquire_page(capture, skin, check, lamina_command_line(arguments),
                                         is_device(options.capture) || options.capture == "-"
                                             ? ""
                                             : read_file_bytes(options.capture, memory)));
  JsonOutput json = json_of(capture, skin, check, files);
  json["report"] = page.string();
  json["solving_seconds"] = solved;
  write_file((folder / result_file).string(), json.text(1) + "\n");
  write_json(json, options.common);
  print(options.common,
        text_of(capture, skin, check, said) + fmt::format("solved in {:.1f} s; {}, {}\n", solved,
                                                          files.material.string(), page.string()));
}

}  // namespace

void add_acquire_command(CLI::App& app) {
  auto options = std::make_shared<AcquireOptions>();
  const Command command(app, "acquire",
                        "Maps of melanin, blood and other numbers of skin from photographs, each "
                        "with its error.");
  command.add_option("capture", options->capture, "capture file").type_name("CAPTURE").required();
  add_settings_option(command, options->settings, "capture file");
  command
      .add_option("-o,--output", options->output,
                  "folder for an EXR per number, one of its standard deviation, material.json that "
                  "uses them, and report.html")
      .type_name("FOLDER");
  command.add_choice("--lateral", options->lateral,
                     "transport: light travels sideways in the skin; none: each pixel by itself; "
                     "auto: transport where mm_per_pixel is known and the capture is no texture");
  command
      .add_option("--most-forwards", options->most_forwards,
                  "ends after so many forward models, their changes and gradients")
      .range(1, 1e6)
      .show_default()
      .group("Maps with transport");
  command
      .add_option("--model-error", options->model_error,
                  "error of the forward model, relative, that joins the noise")
      .range(0, 0.5)
      .show_default()
      .group("Maps with transport");
  command
      .add_option("--robust", options->robust_limit,
                  "residuals beyond so many standard deviations count less; 0: all alike")
      .range(0, 1e6)
      .show_default()
      .group("Maps with transport");
  command.add_flag("--resume", options->resumes, "go on from the maps in the folder")
      .group("Maps with transport");
  const std::string large = "Captures that are solved by tiles";
  command
      .add_memory_size(
          "--tile-memory", options->tile_memory,
          "memory that the inversion may take, 1GiB if not given; what would take more "
          "goes by tiles")
      .group(large);
  command
      .add_option("--tiles", options->tiles,
                  "keeps each tile in this folder, and takes those that are there: a call that was "
                  "stopped goes on, and machines share the work")
      .type_name("FOLDER")
      .group(large);
  command
      .add_option(
          "--shard", options->shard,
          "only part I of N of the tiles, and no maps; the same call without it makes these "
          "of all, bit by bit those of one machine")
      .type_name("I/N")
      .group(large);
  command
      .add_flag("--prepare", options->only_prepares,
                "only the tile of which most is known, whose smoothness all take; a shard makes it "
                "where it is missing")
      .group(large);
  command.add_flag("--check", options->only_checks,
                   "reads the photographs and says how many tiles there are");
  for (const char* name : {"--most-forwards", "--model-error", "--robust", "--resume",
                           "--tile-memory", "--tiles", "--shard", "--prepare"})
    options->of_transport.emplace_back(name, command.option(name));
  add_common_options(command, options->common);
  command.footer(
      "docs/acquire.md has the file format; a capture file may be as short as\n"
      "  { \"lamina\": \"capture\", \"version\": 1,\n"
      "    \"images\": [ { \"image\": \"skin.png\", \"encoding\": \"srgb\", \"sensor\": \"srgb\" } "
      "] }\n"
      "Example: lamina acquire skin.json -o maps && xdg-open maps/report.html");
  command.callback([options] { run_acquire(*options); });
}

}  // namespace lamina::cli
