// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/exchange/material_import.h"
#include "lamina/exchange/misfit_json.h"

namespace lamina::cli {
namespace {

struct ImportOptions {
  CommonOptions common;
  ImportedParameters what;
  std::vector<double> color, radius;
  std::string output;
};

std::array<double, 3> three(const std::vector<double>& numbers, const std::string& option) {
  if (numbers.size() != 1 && numbers.size() != 3)
    throw InvalidInput(fmt::format("{}: must be three numbers, or one for all, but are {}", option,
                                   numbers.size()));
  std::array<double, 3> result{};
  for (std::size_t c = 0; c < 3; ++c) result[c] = numbers[numbers.size() == 1 ? 0 : c];
  return result;
}

void run_import(const ImportOptions& options) {
  ImportedParameters what = options.what;
  what.color = three(options.color, "--color");
  what.radius = three(options.radius, "--radius");
  const ImportedMaterial imported = import_material(what, make_progress("import", Keeps::nothing));
  write_file(options.output, format_material(imported.material));
  const MaterialLayer& layer = imported.material.layers.front();
  JsonOutput json = make_result("import");
  json["output"] = options.output;
  json["sigma_a"] = layer.sigma_a;
  json["sigma_s"] = layer.sigma_s;
  json["g"] = what.g;
  json["ior"] = what.ior;
  json["color"] = imported.definition;
  json["misfit"] = misfit_json(imported.misfits);
  json["notes"] = imported.notes;
  write_json(json, options.common);
  std::string text =
      fmt::format("{}\n{:<16}{:>12}{:>12}{:>12}\n", options.output, "", "R", "G", "B");
  const auto row = [&](const std::string& name, const std::vector<double>& values) {
    text +=
        fmt::format("{:<16}{:>12.6g}{:>12.6g}{:>12.6g}\n", name, values[0], values[1], values[2]);
  };
  row("sigma_a [1/mm]", layer.sigma_a);
  row("sigma_s [1/mm]", layer.sigma_s);
  if (!imported.misfits.empty()) {
    std::vector<double> rms;
    for (const ChannelMisfit& misfit : imported.misfits)
      rms.push_back(misfit.reflectance.spread->profile_rms);
    row("profile rms", rms);
  }
  text += "color " + imported.definition + "\n";
  for (const std::string& note : imported.notes) text += "note: " + note + "\n";
  print(options.common, text);
}

}  // namespace

void add_import_command(CLI::App& app) {
  auto options = std::make_shared<ImportOptions>();
  const Command command(app, "import",
                        "A material file from the subsurface parameters of another renderer");
  command.add_choice("--from", options->what.source, "whose parameters they are").required();
  command.add_choice(
      "--blender", options->what.blender,
      "of principled: the version, 3 (3.0 to 3.6), 4 (4.0 to 5.1), or 5.2 and later");
  command.add_option("--color", options->color, "the color of subsurface, linear light")
      .type_name("R G B")
      .required();
  command.add_option("--radius", options->radius, "its radius, in scene units")
      .type_name("R G B")
      .required();
  command.add_option("--scale", options->what.scale, "of the radius")
      .range(1e-9, 1e9)
      .show_default();
  command.add_option("--g", options->what.g, "anisotropy").range(0.0, 0.9).show_default();
  command.add_option("--ior", options->what.ior, "of the surface").range(1.0, 1.6).show_default();
  command.add_option("--roughness", options->what.roughness, "of the surface, as the slider has it")
      .range(0.0, 1.0)
      .show_default();
  command.add_option("--mm-per-unit", options->what.mm_per_unit, "the unit of its scene in mm")
      .range(1e-9, 1e9)
      .show_default();
  command.add_output_file("-o,--output", options->output, "the material file (.json)", ".json")
      .required();
  add_common_options(command, options->common);
  command.footer(
      "The material returns as much light as the other renderer's does under the same surface, "
      "and\n"
      "spreads it as nearly as can be: the rms of what the profiles differ is printed.\n\n"
      "Example: a wax of Blender 4, in a scene of meters\n"
      "  lamina import --from principled --color .8 .6 .4 --radius 1 .5 .3 --scale .01 \\\n"
      "    --mm-per-unit 1000 -o wax.json");
  command.callback([options] { run_import(*options); });
}

}  // namespace lamina::cli
