// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/write_places.h"
#include "lamina/exchange/export_format.h"
#include "lamina/exchange/misfit_json.h"
#include "material_bands.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

struct ExportCommandOptions {
  CommonOptions common;
  std::string material, bands, output;
  std::vector<std::string> settings;  ///< of --set
  std::vector<std::string> formats;
  std::string mesh;      ///< a GLB, or empty
  std::string channels;  ///< empty: what each format has best
  ExportOptions what;
};

std::string formats_text() {
  std::string text;
  for (const ExportFormat& format : export_formats())
    text += fmt::format("  {:<12} {}\n", format.name, format.about);
  return text;
}

void list_formats(const CommonOptions& options) {
  JsonOutput formats = JsonOutput::array();
  for (const ExportFormat& format : export_formats())
    formats.push_back({{"name", format.name},
                       {"about", format.about},
                       {"ending", format.ending},
                       {"channels", name_of(format.channels)}});
  JsonOutput result = make_result("export");
  result["formats"] = std::move(formats);
  write_json(result, options);
  print(options, formats_text());
}

/// The formats that --to names, each once; "all" is every one.
std::vector<const ExportFormat*> chosen_formats(const std::vector<std::string>& names) {
  std::vector<const ExportFormat*> chosen;
  const auto choose = [&](const ExportFormat& format) {
    if (std::ranges::find(chosen, &format) == chosen.end()) chosen.push_back(&format);
  };
  for (const std::string& name : names) {
    if (name == "all") {
      for (const ExportFormat& format : export_formats()) choose(format);
      continue;
    }
    try {
      choose(find_export_format(name));
    } catch (const InvalidInput& error) {
      throw InvalidInput(std::string("--to: ") + error.what() +
                         "; lamina export --to list has all");
    }
  }
  return chosen;
}

/// Where files of one format go if -o names one of them, as does skin.py: that one there, the
/// others beside it, called after it. If it ends as lamina would have it, in "_blender.py", they
/// are called after what is before that. Empty if it names none, but a folder.
std::vector<fs::path> places_beside(const std::vector<ExportedFile>& files, const fs::path& output,
                                    const std::string& stem) {
  const std::string name = output.filename().string();
  const auto ending_of = [&](const ExportedFile& file) { return file.name.substr(stem.size()); };
  const auto is_of_its_kind = [&](const ExportedFile& file) {
    return fs::path(file.name).extension() == output.extension();
  };
  const auto named = std::ranges::find_if(files, [&](const ExportedFile& file) {
    return name.ends_with(ending_of(file)) && name != ending_of(file);
  });
  const auto of_its_kind = std::ranges::count_if(files, is_of_its_kind);
  std::vector<fs::path> places;
  if (of_its_kind == 0) return places;
  const std::string beside = named != files.end()
                                 ? name.substr(0, name.size() - ending_of(*named).size())
                                 : output.stem().string();
  for (const ExportedFile& file : files) {
    const bool is_output = named == files.end() && of_its_kind == 1 && is_of_its_kind(file);
    places.push_back(is_output ? output : output.parent_path() / (beside + ending_of(file)));
  }
  return places;
}

/// Where the files go: to what -o names, unless that is a folder; several into it.
std::vector<fs::path> places_of(const std::vector<ExportedMaterial>& exported,
                                const std::string& output, const std::string& stem) {
  std::error_code ignored;
  const fs::path folder = output.empty() ? "." : output;
  if (exported.size() == 1 && !output.empty() && !output.ends_with('/') &&
      !fs::is_directory(folder, ignored)) {
    if (exported[0].files.size() == 1) return {folder};
    std::vector<fs::path> places = places_beside(exported[0].files, folder, stem);
    if (!places.empty()) return places;
  }
  std::vector<fs::path> places;
  std::set<std::string> names;
  for (const ExportedMaterial& one : exported)
    for (const ExportedFile& file : one.files) {
      if (!names.insert(file.name).second)
        throw InvalidInput("--to: two formats write " + file.name + "; export them one by one");
      places.push_back(folder / file.name);
    }
  make_folder(folder);
  return places;
}

std::string light_text(const LightMisfit& misfit) {
  std::string text = fmt::format("{:>8.5f} {:>8.5f}", misfit.wanted_total, misfit.obtained_total);
  if (misfit.spread)
    text += fmt::format("  {:>9.3g} {:>9.3g}  {:>6.3f}", misfit.spread->wanted_mean_square_radius,
                        misfit.spread->obtained_mean_square_radius, misfit.spread->profile_rms);
  return text;
}

std::string misfit_text(const std::vector<ChannelMisfit>& misfits) {
  if (misfits.empty()) return "";
  std::string text =
      "           total             mean square radius [mm^2]  profile\n"
      "           wanted   obtained    wanted  obtained     rms\n";
  for (const ChannelMisfit& misfit : misfits) {
    text += fmt::format("  {:<5} R {}\n", misfit.channel, light_text(misfit.reflectance));
    if (misfit.transmittance)
      text += fmt::format("  {:<5} T {}\n", misfit.channel, light_text(*misfit.transmittance));
  }
  return text;
}

void run_export(const ExportCommandOptions& options) {
  const std::vector<const ExportFormat*> formats = chosen_formats(options.formats);
  const Material material =
      find_material_at({options.material, options.bands, options.settings}, options.common.memory);
  ExportOptions what = options.what;
  if (!options.channels.empty()) what.channels = find_enum_value<ExportChannels>(options.channels);
  if (!options.mesh.empty()) {
    what.glb = read_file_bytes(options.mesh);
    what.glb_name = options.mesh;
  }
  what.skips_refused = std::ranges::find(options.formats, "all") != options.formats.end();
  what.progress = make_progress("export " + material.name, Keeps::nothing);
  const std::vector<ExportedMaterial> exported = export_material(material, formats, what);
  const std::vector<fs::path> places =
      places_of(exported, options.output, file_stem(material.name));
  std::vector<NamedFile> named = {{"the material", options.material},
                                  {"--mesh", options.mesh},
                                  {"--json", options.common.json}};
  for (const fs::path& place : places) {
    named.push_back({"an exported file", place.string()});
    require_writable(place.string());
  }
  require_different(named);
  JsonOutput result = make_result("export");
  result["material"] = material.name;
  result["mm_per_unit"] = what.mm_per_unit;
  JsonOutput all = JsonOutput::array();
  std::string text;
  std::size_t next = 0;
  for (std::size_t i = 0; i < exported.size(); ++i) {
    const ExportedMaterial& one = exported[i];
    JsonOutput files = JsonOutput::array();
    text += fmt::format("{}{}\n", i > 0 ? "\n" : "", formats[i]->name);
    for (const ExportedFile& file : one.files) {
      const fs::path& place = places[next++];
      write_file(place.string(), file.bytes);
      files.push_back(place.string());
      text += fmt::format("  {}\n", printable(place.string(), ""));
    }
    if (!one.refusal.empty()) text += fmt::format("  not written: {}\n", one.refusal);
    text += misfit_text(one.misfits);
    for (const std::string& note : one.notes) text += fmt::format("  note: {}\n", note);
    all.push_back({{"format", formats[i]->name},
                   {"files", files},
                   {"misfit", misfit_json(one.misfits)},
                   {"notes", one.notes}});
    if (!one.refusal.empty()) all.back()["refusal"] = one.refusal;
  }
  result["exports"] = std::move(all);
  write_json(result, options.common);
  print(options.common, text);
}

}  // namespace

void add_export_command(CLI::App& app) {
  auto options = std::make_shared<ExportCommandOptions>();
  const Command command(app, "export",
                        "Write a material for another renderer or solver, with what is lost");
  command.add_option("material", options->material, "a material file or a built-in material")
      .type_name("MATERIAL");
  command
      .add_option("--to", options->formats,
                  "a format, several with a comma between, or all; list: lists them")
      .type_name("FORMAT")
      .delimiter(',')
      .required();
  command
      .add_option(
          "-o,--output", options->output,
          "the file, with others of the format beside it, or a folder; otherwise this folder, "
          "and files are called as the material")
      .type_name("PATH");
  add_material_options(command, options->bands, options->settings);
  command
      .add_option("--channels", options->channels,
                  "rgb or bands, instead of what the format has best: a spectral material becomes "
                  "R, G, B by the colors of its light")
      .one_of({"rgb", "bands"});
  command
      .add_option("--mm-per-unit", options->what.mm_per_unit,
                  "the unit of the target's scene in mm")
      .range(1e-9, 1e9)
      .show_default();
  command
      .add_option(
          "--g", options->what.g,
          "mean cosine of the one medium that stands for layers; otherwise that of a single "
          "layer, and 0 for several, or in sheets their mean if that is nearer")
      .range(-0.99, 0.99);
  command.add_option("--ior", options->what.ior, "its index; otherwise that of the upper layer")
      .range(0.1, 10.0);
  command.add_choice("--match", options->what.goal,
                     "what it has in common with the layers besides the total");
  command.add_option("--gaussians", options->what.gaussians, "of sums of Gaussians: how many")
      .type_name("N")
      .range(1, 40)
      .show_default();
  add_common_options(command, options->common);
  command.add_option("--mesh", options->mesh, "of gltf: a GLB whose copy gets the material")
      .type_name("FILE.glb");
  command.add_flag("--scatter", options->what.gltf_scatter,
                   "of gltf: writes the draft KHR_materials_scatter for thick materials");
  command.footer(
      "Formats:\n" + formats_text() +
      "\nLayers that a format cannot say are fitted by what they do to diffuse light. What "
      "that\nmisses is printed, stands in the file, and in --json. Rms of a profile: of the "
      "difference\nover the mean of both, weighted by flux.\n\n"
      "Example: skin for screen space, in a scene of centimeters\n"
      "  lamina export skin_type_3 --to gaussians --mm-per-unit 10 -o skin.json");
  command.callback([options] {
    if (options->formats == std::vector<std::string>{"list"}) return list_formats(options->common);
    if (options->material.empty())
      throw InvalidInput("MATERIAL: is required, a material file or a built-in material");
    run_export(*options);
  });
}

}  // namespace lamina::cli
