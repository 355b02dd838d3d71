// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <string>

#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/layers/materials/builtin_texts.h"
#include "lamina/layers/materials/material.h"
#include "material_bands.h"
#ifdef LAMINA_RENDER
#include "render_swatch.h"
#endif

namespace lamina::cli {
namespace {

struct MaterialsOptions {
  CommonOptions common;
  std::string name, bands, swatch;
  std::vector<std::string> settings;  ///< of --set
};

std::string bands_text(const BandSet& bands) {
  return bands.is_rgb() ? "rgb" : fmt::format("{} nm", bands.size());
}

JsonOutput summary(const Material& material) {
  JsonOutput layers = JsonOutput::array();
  for (const MaterialLayer& layer : material.layers) layers.push_back(layer.name);
  return {{"name", material.name},
          {"layers", layers},
          {"bands", bands_json(material.bands)},
          {"source", material.source}};
}

void list_materials(const CommonOptions& options) {
  std::size_t width = 4;
  for (const Material& material : builtin_materials())
    width = std::max(width, material.name.size());
  std::string text = fmt::format("{:<{}}  layers  bands  source\n", "name", width);
  JsonOutput list = JsonOutput::array();
  for (const Material& material : builtin_materials()) {
    text += fmt::format("{:<{}}  {:>6}  {:<5}  {}\n", material.name, width, material.layers.size(),
                        bands_text(material.bands), material.source);
    list.push_back(summary(material));
  }
  JsonOutput result = make_result("materials");
  result["materials"] = std::move(list);
  write_json(result, options);
  print(options, text);
}

void show_material(const MaterialChoice& choice, const CommonOptions& options) {
  const std::string& name = choice.name;
  const Material material = find_unnamed_material_at(choice, options.memory);
  const auto& names = builtin_material_names();
  const bool is_builtin = std::ranges::find(names, name) != names.end();
  const std::string text = is_builtin && choice.bands.empty() && choice.settings.empty()
                               ? builtin_material_text(name)
                               : format_material(material);
  JsonOutput result = make_result("materials");
  result["material"] = JsonOutput(parse_json(text, name).root());
  write_json(result, options);
  print(options, text);
}

}  // namespace

void add_materials_command(CLI::App& app) {
  auto options = std::make_shared<MaterialsOptions>();
  const Command command(app, "materials", "List the built-in materials, or print the file of one");
  command
      .add_option("name", options->name,
                  "a built-in material, or a file to check and print in mm; without it, all "
                  "built-in materials are listed")
      .type_name("NAME");
  add_material_options(command, options->bands, options->settings);
#ifdef LAMINA_RENDER
  command
      .add_output_file("--swatch", options->swatch,
                       "render a ball of the material, as it looks, in place of printing it",
                       ".png")
      .type_name("FILE.png");
#endif
  add_common_options(command, options->common);
  command.footer(
      "Example: a material of your own, starting from a built-in one\n"
      "  lamina materials jade > my_jade.json");
  command.callback([options] {
    if (options->name.empty() && !options->bands.empty())
      throw InvalidInput("--bands: must be left out without a material");
    if (options->name.empty() && !options->settings.empty())
      throw InvalidInput("--set: must be left out without a material");
    if (options->name.empty() && !options->swatch.empty())
      throw InvalidInput("--swatch: must be left out without a material");
#ifdef LAMINA_RENDER
    if (!options->swatch.empty()) {
      save_swatch(find_material_at({options->name, options->bands, options->settings},
                                   options->common.memory),
                  options->swatch);
      return;
    }
#endif
    if (options->name.empty())
      list_materials(options->common);
    else
      show_material({options->name, options->bands, options->settings}, options->common);
  });
}

}  // namespace lamina::cli
