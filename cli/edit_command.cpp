// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "edit_steps.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/base/io/write_places.h"
#include "lamina/skin/acquire/bands/band_choice.h"
#include "lamina/skin/maps/edits/files/editable_skin_file.h"
#include "lamina/skin/maps/edits/skin_preview.h"
#include "lamina/skin/maps/edits/skin_variations.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

constexpr int preview_side = 512;  // texels

struct EditOptions {
  CommonOptions common;
  std::string maps, output, population = "forearms";
  std::vector<EditStep> steps;
  double mm_per_pixel = 0.0;
  int variations = 0;
  bool has_no_preview = false;
};

/// A map before and after, by its name.
struct MapChange {
  std::string name;
  JsonOutput before, after;  ///< null: a number before
  std::string text;
  std::size_t clamped = 0;
};

struct Spread {
  double mean, low, high;  ///< 5 and 95 % of the texels lie below
};

Spread spread_of(const Image& map) {
  std::vector<float> values = map.pixels;
  double sum = 0.0;
  for (const float value : values) sum += static_cast<double>(value);
  const auto at = [&](double share) {
    const auto place = values.begin() +
                       static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, place);
    return static_cast<double>(*place);
  };
  return {sum / static_cast<double>(values.size()), at(0.05), at(0.95)};
}

JsonOutput spread_json(const Spread& spread) {
  return {{"mean", spread.mean}, {"percentile_5", spread.low}, {"percentile_95", spread.high}};
}

std::string spread_text(const Spread& spread) {
  return fmt::format("{:.4g} ({:.4g} to {:.4g})", spread.mean, spread.low, spread.high);
}

std::vector<MapChange> changes_between(const SkinMaps& before, const SkinMaps& after,
                                       const std::vector<ClampedTexels>& clamped) {
  std::vector<MapChange> changes;
  const auto add = [&](const std::string& name, const Image* old, const Image& now) {
    MapChange change{.name = name, .before = {}, .after = {}, .text = {}};
    const Spread then = spread_of(now);
    change.after = spread_json(then);
    change.text = spread_text(then);
    if (old) {
      const Spread first = spread_of(*old);
      change.before = spread_json(first);
      if (old->pixels != now.pixels) change.text = spread_text(first) + " -> " + change.text;
    }
    for (const ClampedTexels& each : clamped)
      if (each.name == name) change.clamped += each.count;
    changes.push_back(std::move(change));
  };
  for (const SkinMap& map : after.maps) {
    const auto old = std::ranges::find(before.maps, map.name, &SkinMap::name);
    add(map.name, old == before.maps.end() ? nullptr : &old->values, map.values);
  }
  if (!after.others.empty())
    add("oiliness", before.others.empty() ? nullptr : &before.others.front().values,
        after.others.front().values);
  return changes;
}

/// Numbers without a map that have changed, a line each.
void describe_numbers(const SkinMaps& before, const SkinMaps& after, std::string& text,
                      JsonOutput& json) {
  for (const SkinParameterRange& range : skin_parameter_ranges()) {
    const double old = before.skin.*range.value, now = after.skin.*range.value;
    const bool is_map =
        std::ranges::find(after.maps, range.name, &SkinMap::name) != after.maps.end();
    if (is_map || old == now) continue;
    text += fmt::format("{}: {:.4g} -> {:.4g}\n", range.name, old, now);
    json["numbers"][range.name] = {{"before", std::isfinite(old) ? JsonOutput(old) : JsonOutput()},
                                   {"after", now}};
  }
}

JsonOutput color_json(const Lab& color) {
  return {{"L", color.lightness}, {"a", color.a}, {"b", color.b}, {"ita", typology_angle(color)}};
}

void require_other_folder(const EditOptions& options) {
  for (const char* ending : {".exr", ".png", ".json"})
    if (lower_case_ending(options.output) == ending)
      throw InvalidInput("--output: must be a folder, not a file, but is " + options.output);
  std::error_code ignored;
  if (fs::exists(options.output, ignored) && !fs::is_directory(options.output, ignored))
    throw InvalidInput("--output: must be a folder, not a file, but is " + options.output);
  require_writable_folder(options.output);
  fs::path from = options.maps;
  if (!fs::is_directory(from, ignored)) from = fs::absolute(from, ignored).parent_path();
  if (fs::equivalent(from, options.output, ignored))
    throw InvalidInput("--output: must be another folder than that of the maps, but is " +
                       options.output);
}

EditableSkin load_maps(const EditOptions& options) {
  EditableSkin skin = load_editable_skin(options.maps, options.common.memory);
  std::error_code ignored;
  for (const char* name : {"patch.json", "material.json"})
    if (std::ranges::find(skin.files, name, &MapsFile::name) == skin.files.end() &&
        fs::exists(fs::path(options.output) / name, ignored))
      throw InvalidInput(fmt::format("--output: {} has a {} of other maps; give another folder",
                                     options.output, name));
  if (!(options.mm_per_pixel > 0.0)) return skin;
  if (skin.width_mm > 0.0)
    throw InvalidInput("--mm-per-pixel: is for maps over a mesh, but a patch says it itself");
  if (const Image* map = first_map(skin.skin)) skin.width_mm = options.mm_per_pixel * map->width;
  return skin;
}

/// Persons of a population in the skin of the maps, a folder each.
void save_variations(const EditOptions& options, const EditableSkin& skin, const Progress& progress,
                     std::string& text, JsonOutput& json) {
  const SkinPopulation population = find_skin_population(options.population, options.common.memory);
  const std::vector<SkinParameters> persons =
      draw_skins(population, options.variations, options.common.seed);
  for (std::size_t i = 0; i < persons.size(); ++i) {
    report_or_throw(progress, static_cast<double>(i) / static_cast<double>(persons.size()));
    const EditedSkin person = skin_of_person(skin, persons[i]);
    const fs::path folder = fs::path(options.output) / fmt::format("{:04}", i);
    JsonOutput each = {{"folder", folder.string()}};
    for (const std::string& name : population.names)
      for (const SkinFitNumber& number : skin_fit_numbers({}))
        if (number.parameter.name == name) each[name] = persons[i].*number.values[0];
    for (const ClampedTexels& clamped : person.clamped)
      each["clamped"][clamped.name] = clamped.count;
    if (!options.has_no_preview) {
      const Image picture = skin_preview(person.skin, preview_side / 2, user_cache());
      const Lab color = mean_lab(picture, skin.mask);
      each["color"] = color_json(color);
      make_folder(folder);
      save_png(picture, folder / "preview.png");
      text += fmt::format("{}: L* {:.1f}, ITA {:.0f} deg\n", folder.string(), color.lightness,
                          typology_angle(color));
    } else {
      text += folder.string() + "\n";
    }
    save_editable_skin(person.skin, folder, LAMINA_VERSION, options.maps);
    json["variations"].push_back(std::move(each));
  }
}

void run_edit(const EditOptions& options) {
  if (options.steps.empty() && options.variations == 0)
    throw InvalidInput("there must be an edit, as --tan 0.3, or --augment");
  require_other_folder(options);
  const Progress progress = make_progress("editing maps", Keeps::nothing);
  const EditableSkin original = load_maps(options);
  EditableSkin skin = original;
  std::vector<ClampedTexels> clamped;
  JsonOutput json = make_result("edit");
  json["edits"] = JsonOutput::array();
  for (const EditStep& step : options.steps) {
    MemoryBudget memory = options.common.memory;
    const SkinEdit edit = decode_step(step, memory);
    try {
      EditedSkin edited = edited_skin(std::move(skin), edit);
      skin = std::move(edited.skin);
      clamped.insert(clamped.end(), edited.clamped.begin(), edited.clamped.end());
    } catch (const InvalidInput& error) {
      throw InvalidInput(option_of(step) + ": " + error.what());
    }
    json["edits"].push_back(step_json(step));
    report_or_throw(progress, 0.0);
  }
  for (const ClampedTexels& each : clamped)
    skin.skin.warnings.push_back(
        fmt::format("{}: {} texels reached the end of its range", each.name, each.count));
  for (const std::string& warning : skin.skin.warnings) say("warning: " + warning);
  json["warnings"] = skin.skin.warnings;
  json["maps"] = JsonOutput::array();
  std::string text;
  for (MapChange& change : changes_between(original.skin, skin.skin, clamped)) {
    text += fmt::format("{}: {}\n", change.name, change.text);
    json["maps"].push_back({{"parameter", change.name},
                            {"file", (fs::path(options.output) / (change.name + ".exr")).string()},
                            {"before", std::move(change.before)},
                            {"after", std::move(change.after)},
                            {"clamped", change.clamped}});
  }
  describe_numbers(original.skin, skin.skin, text, json);
  if (options.variations > 0) {
    make_folder(options.output);
    save_variations(options, skin, progress, text, json);
  } else {
    const fs::path folder = options.output;
    if (!options.has_no_preview) {
      const Image before = skin_preview(original, preview_side, user_cache(), progress);
      const Image after = skin_preview(skin, preview_side, user_cache(), progress);
      const Lab from = mean_lab(before, skin.mask), to = mean_lab(after, skin.mask);
      text += fmt::format(
          "mean color: L* {:.1f} -> {:.1f}, a* {:.1f} -> {:.1f}, b* {:.1f} -> {:.1f}, ITA {:.0f} "
          "-> {:.0f} deg\n",
          from.lightness, to.lightness, from.a, to.a, from.b, to.b, typology_angle(from),
          typology_angle(to));
      json["color"] = {{"before", color_json(from)}, {"after", color_json(to)}};
      make_folder(folder);
      save_png(after, folder / "preview.png");
      save_png(side_by_side(before, after), folder / "before_after.png");
    }
    save_editable_skin(skin, folder, LAMINA_VERSION, options.maps);
    for (const MapsFile& each : skin.files) {
      const std::string file = (folder / each.name).string();
      json["files"].push_back(file);
      text += file + "\n";
    }
  }
  write_json(json, options.common);
  print(options.common, text);
}

}  // namespace

void add_edit_command(CLI::App& app) {
  auto options = std::make_shared<EditOptions>();
  const Command command(app, "edit",
                        "Edits maps of what skin is made of: a tan, a flush, freckles, make-up, "
                        "someone else's skin.");
  command
      .add_option("maps", options->maps,
                  "a folder that lamina maps or lamina acquire has made, or its patch.json or "
                  "material.json")
      .type_name("MAPS")
      .required();
  command
      .add_option("-o,--output", options->output,
                  "folder for the edited maps, the file that uses them, preview.png and "
                  "before_after.png")
      .type_name("FOLDER")
      .required();
  add_edit_steps(command, options->steps);
  command
      .add_option("--augment", options->variations,
                  "after the edits, this many persons of --population with these maps: means are "
                  "theirs, detail stays; a folder each, 0000, 0001, ...; by --seed")
      .type_name("N")
      .range(1, 10000);
  command
      .add_option("--population", options->population,
                  "\"forearms\" or a population file, for --augment")
      .type_name("NAME|FILE")
      .show_default();
  command
      .add_option("--mm-per-pixel", options->mm_per_pixel,
                  "width of a texel, for edits by size of maps over a mesh")
      .type_name("MM")
      .range(1e-3, 100.0);
  command.add_flag("--no-preview", options->has_no_preview, "make no pictures, which take seconds");
  add_common_options(command, options->common);
  command.footer(
      "docs/edit.md says what each edit does to which number. The maps stay as they are; edits may "
      "be edited again.\n"
      "Example: a tan with stronger freckles, and a flush where the mask is white\n"
      "  lamina edit freckles -o tanned --tan 0.5 --freckles 0.3 --flush 0.8 --mask cheek.png");
  command.callback([options] { run_edit(*options); });
}

}  // namespace lamina::cli
