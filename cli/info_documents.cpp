// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Lines of `lamina info` on documents that lamina has a format of its own for.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "cluster_files.h"
#include "cluster_state.h"
#include "info_kinds.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/json_input.h"
#include "lamina/layers/materials/material.h"
#include "lamina/reproduction/item.h"
#include "lamina/scene/skin_surface/surface_skin_maps.h"
#include "lamina/skin/acquire/capture.h"
#include "lamina/skin/acquire/files/capture_file.h"
#include "lamina/skin/fit/measured/measurement.h"
#include "lamina/skin/fit/skin/skin_population.h"
#include "lamina/skin/maps/edits/editable_skin.h"
#include "lamina/skin/maps/edits/files/editable_skin_file.h"
#include "lamina/skin/maps/files/skin_features_file.h"
#include "lamina/skin/maps/skin_features.h"
#include "lamina/skin/patch/files/skin_patch_file.h"
#include "lamina/skin/patch/skin_patch.h"
#include "photons_report.h"
#include "shard_option.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

std::string counted(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

void add_text(FileFacts& facts, const char* name, const std::string& text) {
  if (text.empty()) return;
  facts.lines.emplace_back(name, text);
  facts.json[name] = text;
}

void add_names(FileFacts& facts, const char* what, const std::vector<std::string>& names) {
  facts.lines.emplace_back(
      what, names.empty() ? std::string("none") : fmt::format("{}", fmt::join(names, ", ")));
  facts.json[what] = names;
}

/// The file that a document changes.
void add_base(FileFacts& facts, const FileLook& look, MemoryBudget memory) {
  const JsonDocument document = load_json(look.path, memory);
  if (const auto base = document.root().peek("base"); base && base->is_string())
    add_text(facts, "base", base->string());
}

std::vector<std::string> names_of(const std::vector<SkinMap>& maps) {
  std::vector<std::string> names;
  for (const SkinMap& map : maps)
    names.push_back(fmt::format("{} {} x {}", map.name, map.values.width, map.values.height));
  return names;
}

void add_size(FileFacts& facts, int width, int height, double mm_per_texel) {
  facts.lines.emplace_back("size", fmt::format("{} x {} texels, {:.4g} x {:.4g} mm", width, height,
                                               width * mm_per_texel, height * mm_per_texel));
  facts.json["width"] = width;
  facts.json["height"] = height;
  facts.json["mm_per_texel"] = mm_per_texel;
}

}  // namespace

FileFacts material_facts(const FileLook& look, MemoryBudget memory) {
  std::vector<std::string> maps;
  const auto noted = [&](const MappableNumber& number, const JsonInput&) {
    maps.push_back(number.name);
    // Wavelengths of that many bands, in the range: the file is not used, only looked at.
    const double middle = 0.5 * (number.low + std::min(number.high, number.low + 1.0));
    return std::vector<double>(std::max<std::size_t>(number.channels.size(), 1), middle);
  };
  const Material material = load_material(look.path, memory, noted);
  FileFacts facts;
  add_base(facts, look, memory);
  add_text(facts, "name", material.name);
  add_text(facts, "source", material.source);
  add_bands(facts, material.bands);
  std::vector<std::string> layers;
  for (const MaterialLayer& layer : material.layers)
    layers.push_back(layer.name.empty() ? fmt::format("layer {}", layers.size()) : layer.name);
  add_names(facts, "layers", layers);
  if (!maps.empty()) add_names(facts, "maps", maps);
  return facts;
}

FileFacts capture_facts(const FileLook& look, MemoryBudget memory) {
  const CaptureDescription description = load_capture({look.path.string()}, memory);
  const Capture& capture = description.capture;
  FileFacts facts;
  add_base(facts, look, memory);
  add_text(facts, "name", capture.name);
  const PixelMask& image = description.photographs[0].mask;
  facts.lines.emplace_back(
      "size", fmt::format("{} x {} pixels{}", image.width, image.height,
                          capture.mm_per_pixel ? fmt::format(", {:.4g} x {:.4g} mm",
                                                             image.width * *capture.mm_per_pixel,
                                                             image.height * *capture.mm_per_pixel)
                                               : std::string(" of unknown size")));
  facts.json["width"] = image.width;
  facts.json["height"] = image.height;
  if (capture.mm_per_pixel) facts.json["mm_per_pixel"] = *capture.mm_per_pixel;
  add_names(facts, "bands", capture.reflectance.channels);
  if (!capture.wavelengths.empty())
    facts.lines.emplace_back("",
                             fmt::format("seen from {:g} to {:g} nm", capture.wavelengths.front(),
                                         capture.wavelengths.back()));
  std::vector<std::string> free;
  for (const SkinFitNumber& number : capture.numbers) free.push_back(number.parameter.name);
  add_names(facts, "finds", capture.leaf ? std::vector<std::string>{"a leaf"} : free);
  add_text(facts, "population", capture.population_name);
  return facts;
}

FileFacts patch_facts(const FileLook& look, MemoryBudget memory) {
  const SkinPatch patch = load_skin_patch({look.path.string()}, memory);
  FileFacts facts;
  add_base(facts, look, memory);
  add_text(facts, "name", patch.name);
  add_size(facts, patch.width, patch.height, patch.mm_per_texel);
  add_bands(facts, patch.bands);
  std::vector<std::string> maps = names_of(patch.skin.maps);
  if (patch.material)
    for (const MaterialMap& map : patch.material->maps) maps.push_back(map.number.name);
  add_names(facts, "maps", maps);
  facts.warnings = patch.warnings;
  return facts;
}

FileFacts measurement_facts(const FileLook& look, MemoryBudget memory) {
  const Measurement measurement = load_measurement({look.path.string()}, memory);
  FileFacts facts;
  add_base(facts, look, memory);
  add_text(facts, "name", measurement.name);
  add_text(facts, "source", measurement.source);
  add_bands(facts, measurement.bands);
  std::vector<std::string> series, free;
  for (const MeasuredSeries& each : measurement.series) {
    const auto kind = std::ranges::find(enum_names<MeasurementKind>, each.kind,
                                        &EnumName<MeasurementKind>::value);
    series.push_back(fmt::format("{}: {}", kind->name, counted(each.points.size(), "number")));
  }
  for (const FreeNumber& number : measurement.free)
    free.push_back(number.parameter.name + (number.is_per_band ? " in each band" : ""));
  add_names(facts, "measured", series);
  add_names(facts, "free", free);
  return facts;
}

FileFacts population_facts(const FileLook& look, MemoryBudget memory) {
  const SkinPopulation population = load_skin_population(look.path, memory);
  FileFacts facts;
  add_names(facts, "numbers", population.names);
  if (!population.wavelengths.empty()) {
    facts.lines.emplace_back(
        "misfit", fmt::format("known from {:g} to {:g} nm", population.wavelengths.front(),
                              population.wavelengths.back()));
    facts.json["wavelengths_nm"] = population.wavelengths;
  }
  return facts;
}

FileFacts recipe_facts(const FileLook& look, MemoryBudget memory) {
  FileFacts facts;
  add_base(facts, look, memory);
  if (const auto surface = load_surface_map_recipe({look.path.string()}, memory)) {
    facts.lines.emplace_back(
        "size", fmt::format("{} x {} texels over a mesh of {}", surface->width, surface->height,
                            counted(surface->meshes.front().triangles.size(), "triangle")));
    facts.lines.emplace_back("features", fmt::format("{}", surface->features.size()));
    facts.json = {{"width", surface->width},
                  {"height", surface->height},
                  {"features", surface->features.size()}};
    return facts;
  }
  const SkinMapRecipe recipe = load_skin_map_recipe({look.path.string()}, memory);
  add_size(facts, recipe.width, recipe.height, recipe.mm_per_texel);
  facts.lines.emplace_back("features", fmt::format("{}", recipe.features.size()));
  facts.json["features"] = recipe.features.size();
  return facts;
}

FileFacts maps_facts(const FileLook& look, MemoryBudget memory) {
  const EditableSkin skin = load_editable_skin(look.path, memory);
  FileFacts facts;
  if (skin.width_mm > 0.0) {
    facts.lines.emplace_back("width", fmt::format("{:.4g} mm", skin.width_mm));
    facts.json["width_mm"] = skin.width_mm;
  }
  add_names(facts, "maps", names_of(skin.skin.maps));
  std::vector<std::string> known;
  for (const SkinMapDeviation& map : skin.deviations) known.push_back(map.name);
  if (!known.empty()) add_names(facts, "deviations", known);
  facts.json["mask"] = !skin.mask.pixels.empty();
  facts.warnings = skin.skin.warnings;
  return facts;
}

FileFacts job_facts(const FileLook& look, MemoryBudget memory) {
  const ClusterJob job = load_cluster_job(look.path, memory);
  FileFacts facts;
  add_text(facts, "command", command_line(job.command));
  facts.lines.emplace_back("shards", fmt::format("{}", job.shards));
  facts.json["shards"] = job.shards;
  add_text(facts, "time", job.time);
  return facts;
}

FileFacts job_folder_facts(const FileLook& look, MemoryBudget memory) {
  const ClusterFiles files(look.path);
  FileLook of_job = look;
  of_job.path = files.job();
  FileFacts facts = job_facts(of_job, memory);
  const ClusterState state = find_cluster_state(load_cluster_job(files.job(), memory), files);
  const std::size_t done = state.shards_that_are({PartState::Is::done}).size();
  facts.lines.emplace_back("done", fmt::format("{} of {} shards", done, state.shards.size()));
  facts.json["done"] = done;
  facts.warnings = state.warnings;
  return facts;
}

FileFacts reproduction_facts(const FileLook& look, MemoryBudget memory) {
  const JsonDocument document = load_json(look.path, memory);
  const ReproductionItem item = decode_reproduction(document.root(), ReproductionQuality::draft);
  FileFacts facts;
  add_text(facts, "id", item.id);
  add_text(facts, "paper", item.paper);
  add_text(facts, "title", item.title);
  facts.lines.emplace_back(
      "holds", fmt::format("{}, {}", counted(item.runs.size(), "command"),
                           counted(item.numbers.size() + item.features.size(), "check")));
  facts.json["commands"] = item.runs.size();
  facts.json["checks"] = item.numbers.size() + item.features.size();
  return facts;
}

FileFacts photon_counts_facts(const FileLook& look, MemoryBudget memory) {
  FileFacts facts;
  std::vector<std::string> runs;
  for (const PhotonRun& run : load_photon_runs(look.path, memory)) {
    std::string text = run.name;
    if (!run.bands.empty() && !run.bands[0].empty())
      text += fmt::format(", bands {}", fmt::join(run.bands, " "));
    if (run.of > 1) text += fmt::format(", {} of {} shards", run.shards.size(), run.of);
    runs.push_back(std::move(text));
  }
  add_names(facts, "runs", runs);
  return facts;
}

FileFacts result_facts(const FileLook& look, MemoryBudget memory) {
  const JsonDocument document = load_json(look.path, memory);
  FileFacts facts;
  add_text(facts, "lamina", look.said);
  add_text(facts, "command", look.command);
  for (const char* key : {"method", "material", "name"})
    if (const auto value = document.root().peek(key); value && value->is_string())
      add_text(facts, key, value->string());
  return facts;
}

}  // namespace lamina::cli
