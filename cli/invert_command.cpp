// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "invert_texture.h"
#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/spectrum/srgb.h"
#include "lamina/layers/materials/material.h"
#include "lamina/solve/albedo_inversion/half_space_color.h"

namespace lamina::cli {
namespace {

constexpr std::size_t channels = 3;
constexpr std::array<const char*, channels> channel_names = {"R", "G", "B"};
using Rgb = std::array<double, channels>;

/// What --radius may be given in.
struct LengthUnit {
  std::string name;
  double mm;
};
const std::vector<LengthUnit> length_units = {{"mm", 1.0}, {"cm", 10.0}, {"um", 1e-3}, {"m", 1e3}};

struct InvertOptions {
  CommonOptions common;
  HalfSpaceLook look;
  std::vector<std::string> color;
  bool is_srgb = false, checks = false;
  std::vector<double> radius;
  std::string unit = "mm";
  TextureInversion texture;
  std::string output;
};

double number_of(const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [read, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && read == end ? value : std::nan("");
}

/// A color as "#c08060", which is sRGB.
std::optional<Rgb> hexadecimal_color(const std::string& text) {
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  Rgb color;
  for (std::size_t c = 0; c < channels; ++c) {
    const char* const digits = text.data() + 1 + 2 * c;
    int value = 0;
    const auto [read, error] = std::from_chars(digits, digits + 2, value, 16);
    if (error != std::errc() || read != digits + 2 || *digits == '-') return std::nullopt;
    color[c] = srgb_decode(value / 255.0);
  }
  return color;
}

/// Linear light, from what --color says.
Rgb color_of(const InvertOptions& options) {
  const auto refuse = [&] {
    std::string given;
    for (const std::string& part : options.color) given += (given.empty() ? "" : " ") + part;
    return InvalidInput("--color: must be three numbers, one for gray, or #RRGGBB, but is " +
                        given);
  };
  if (options.color.size() == 1)
    if (const auto color = hexadecimal_color(options.color[0])) return *color;
  if (options.color.size() != 1 && options.color.size() != channels) throw refuse();
  Rgb color;
  for (std::size_t c = 0; c < channels; ++c) {
    const double value = number_of(options.color[options.color.size() == 1 ? 0 : c]);
    if (!std::isfinite(value)) throw refuse();
    color[c] = options.is_srgb ? srgb_decode(value) : value;
  }
  return color;
}

/// In mm; 1 where none is given.
Rgb radius_of(const InvertOptions& options) {
  Rgb radius = {1.0, 1.0, 1.0};
  if (options.radius.size() != 0 && options.radius.size() != 1 && options.radius.size() != channels)
    throw InvalidInput(fmt::format("--radius: must be three lengths, or one for all, but are {}",
                                   options.radius.size()));
  const double mm = std::ranges::find(length_units, options.unit, &LengthUnit::name)->mm;
  for (std::size_t c = 0; c < channels && !options.radius.empty(); ++c)
    radius[c] = mm * options.radius[options.radius.size() == 1 ? 0 : c];
  return radius;
}

JsonOutput look_json(const HalfSpaceLook& look) {
  return {{"ior", look.ior},
          {"g", look.g},
          {"roughness", look.top.roughness},
          {"distribution", name_of(look.top.distribution)},
          {"definition", name_of(look.definition)}};
}

JsonOutput limits_json(const HalfSpaceLook& look) {
  const HalfSpaceColor half_space(look);
  return {{"color", JsonOutput::array({half_space.darkest(), half_space.brightest()})},
          {"ior", JsonOutput::array({lowest_look_ior, highest_look_ior})},
          {"g", JsonOutput::array({lowest_look_g, highest_look_g})},
          {"roughness", JsonOutput::array({0.0, 1.0})}};
}

std::string look_text(const HalfSpaceLook& look) {
  std::string text = fmt::format("{}, ior {}, g {}", name_of(look.definition),
                                 number_text(look.ior), number_text(look.g));
  if (look.top.roughness > 0.0)
    text += fmt::format(", roughness {} ({})", number_text(look.top.roughness),
                        name_of(look.top.distribution));
  return text;
}

std::string short_number(double value) { return fmt::format("{:.6g}", value); }

std::string radius_name(RadiusMeaning meaning) {
  std::string name(name_of(meaning));
  std::ranges::replace(name, '_', ' ');
  return name;
}

Material material_of(const InvertOptions& options, const Rgb& color,
                     const std::array<Medium, channels>& media) {
  Material material = half_space_material(media, options.look.top);
  material.name = "half-space of a color";
  material.source =
      fmt::format("lamina invert: linear color {} {} {} by {}", short_number(color[0]),
                  short_number(color[1]), short_number(color[2]), look_text(options.look));
  return material;
}

void run_color(const InvertOptions& options) {
  const Rgb color = color_of(options), radius = radius_of(options);
  const HalfSpaceColor half_space(options.look);
  Rgb albedo;
  std::array<Medium, channels> media;
  for (std::size_t c = 0; c < channels; ++c) {
    try {
      albedo[c] = half_space.albedo(color[c]);
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("--color: {} {} ({})", channel_names[c], error.what(),
                                     look_text(options.look)));
    }
    media[c] = medium_of(options.look, albedo[c], radius[c], options.texture.meaning);
  }

  JsonOutput json = make_result("invert");
  json.update(look_json(options.look));
  json["limits"] = limits_json(options.look);
  json["color"] = color;
  json["albedo"] = albedo;
  json["radius"] = {{"mm", radius}, {"meaning", name_of(options.texture.meaning)}};
  std::string text = fmt::format("{}: colors of {} to {} are reached\n{:<24}{:>12}{:>12}{:>12}",
                                 look_text(options.look), short_number(half_space.darkest()),
                                 short_number(half_space.brightest()), "", "R", "G", "B");
  const auto row = [&](const std::string& name, const auto& value) {
    text += fmt::format("\n{:<24}", name);
    for (std::size_t c = 0; c < channels; ++c)
      text += fmt::format("{:>12}", short_number(value(c)));
  };
  row("color", [&](std::size_t c) { return color[c]; });
  row("albedo", [&](std::size_t c) { return albedo[c]; });
  row(radius_name(options.texture.meaning) + " [mm]", [&](std::size_t c) { return radius[c]; });
  row("sigma_a [1/mm]", [&](std::size_t c) { return media[c].sigma_a; });
  row("sigma_s [1/mm]", [&](std::size_t c) { return media[c].sigma_s; });
  for (const Medium& medium : media) {
    json["sigma_a"].push_back(medium.sigma_a);
    json["sigma_s"].push_back(medium.sigma_s);
  }
  for (const auto& definition : enum_names<ColorDefinition>) {
    HalfSpaceLook look = options.look;
    look.definition = definition.value;
    const HalfSpaceColor of(look);
    Rgb colors;
    for (std::size_t c = 0; c < channels; ++c) colors[c] = of.color(albedo[c]);
    json["colors"][std::string(definition.name)] = colors;
    if (definition.value != options.look.definition)
      row("color by " + std::string(definition.name), [&](std::size_t c) { return colors[c]; });
  }
  if (options.checks) {
    std::array<SolvedColor, channels> solved;
    for (std::size_t c = 0; c < channels; ++c) {
      solved[c] = solve_color(options.look, albedo[c]);
      json["solved"]["color"].push_back(solved[c].color);
      json["solved"]["estimated_error"].push_back(solved[c].estimated_error);
    }
    row("solved without table", [&](std::size_t c) { return solved[c].color; });
    row("off by [%]", [&](std::size_t c) {
      return color[c] > 0.0 ? 100.0 * (solved[c].color / color[c] - 1.0) : 0.0;
    });
  }
  text += options.radius.empty() ? "\nno --radius is given: 1 mm stands for the mean free path\n"
                                 : "\n";
  if (!options.output.empty())
    write_file(options.output, format_material(material_of(options, color, media)));
  write_json(json, options.common);
  print(options.common, text);
}

Rgb mean_albedo(const Image& image) {
  Rgb sum = {};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (std::size_t c = 0; c < channels; ++c) sum[c] += static_cast<double>(image.at(x, y)[c]);
  for (double& channel : sum) channel /= static_cast<double>(image.width) * image.height;
  return sum;
}

void run_texture(InvertOptions options) {
  if (!options.radius.empty()) options.texture.radius = radius_of(options);
  const InvertedTexture inverted =
      invert_texture(options.texture, options.look, options.common.memory,
                     make_progress("invert", Keeps::nothing));
  const std::vector<ImageNote> notes = {
      {"lamina.version", LAMINA_VERSION},
      {"lamina.quantity", options.texture.radius ? "single-scattering albedo; coefficients in 1/mm"
                                                 : "single-scattering albedo"},
      {"lamina.color", look_text(options.look)}};
  save_exr(inverted.image, options.output, ExrPrecision::single_float, notes);
  JsonOutput json = make_result("invert");
  json.update(look_json(options.look));
  json["limits"] = limits_json(options.look);
  json["texture"] = options.texture.file;
  json["output"] = options.output;
  json["size"] = JsonOutput::array({inverted.image.width, inverted.image.height});
  json["mean_albedo"] = mean_albedo(inverted.image);
  json["clamped_texels"] = inverted.clamped;
  write_json(json, options.common);
  std::string text =
      fmt::format("{}: albedo of {} x {} texels ({})\n", options.output, inverted.image.width,
                  inverted.image.height, look_text(options.look));
  if (inverted.clamped > 0)
    text += fmt::format("{} texels took the nearest color that is reached\n", inverted.clamped);
  print(options.common, text);
}

void check_options(const Command& command, const InvertOptions& options) {
  const bool has_color = command.is_given("--color"), has_texture = command.is_given("--texture");
  if (has_color == has_texture)
    throw InvalidInput(has_color ? "--color: must be left out with --texture"
                                 : "--color: is required, or --texture");
  refuse_unused(command, has_texture ? "--texture" : "--color",
                {{"--srgb", {"--color"}},
                 {"--check", {"--color"}},
                 {"--encoding", {"--texture"}},
                 {"--clamp", {"--texture"}}});
  if (options.radius.empty())
    for (const char* option : {"--radius-unit", "--radius-meaning"})
      if (command.is_given(option))
        throw InvalidInput(std::string(option) + ": must be left out without --radius");
  if (has_texture && options.output.empty())
    throw InvalidInput("--output: is required with --texture");
  const std::string ending = has_texture ? ".exr" : ".json";
  if (!options.output.empty() && !is_device(options.output) &&
      lower_case_ending(options.output) != ending)
    throw InvalidInput("--output: must end in " + ending + ", but is " + options.output);
}

}  // namespace

void add_invert_command(CLI::App& app) {
  auto options = std::make_shared<InvertOptions>();
  const Command command(
      app, "invert",
      "The albedo and coefficients with which a translucent half-space has a color.");
  command
      .add_option("--color", options->color,
                  "the color wanted, linear light; one number is gray, #c08060 is sRGB")
      .type_name("R G B|#RRGGBB");
  command.add_flag("--srgb", options->is_srgb, "the numbers of --color are sRGB, 1 is white");
  command
      .add_option("--texture", options->texture.file,
                  "an image of colors (PNG, EXR, TIFF, JPEG, HDR) in place of --color; --output "
                  "gets the albedos")
      .type_name("FILE");
  command.add_choice(
      "--encoding", options->texture.encoding,
      "what the numbers of --texture mean: srgb, what the file says, of integers sRGB where "
      "it says nothing; linear, light; or an encoding by name, whatever it says");
  command.add_flag("--clamp", options->texture.takes_nearest,
                   "give texels that no albedo reaches the nearest color");
  command.add_choice(
      "--definition", options->look.definition,
      "which light is the color. openpbr: sent at 0 degrees, what leaves over what gets "
      "in; normal: over what arrives; diffuse: the same under a uniform sky; furnace: "
      "with the first reflection");
  command.add_option("--ior", options->look.ior, "refractive index")
      .range(lowest_look_ior, highest_look_ior)
      .show_default();
  command
      .add_option("--g", options->look.g, "mean cosine of the scattering angle (Henyey-Greenstein)")
      .range(lowest_look_g, highest_look_g)
      .show_default();
  command
      .add_option("--roughness", options->look.top.roughness,
                  "microfacet alpha of the surface; OpenPBR's specular_roughness squared")
      .range(0.0, 1.0)
      .show_default();
  command.add_choice("--distribution", options->look.top.distribution,
                     "of the facets of a rough surface; OpenPBR's is ggx");
  command.add_option("--radius", options->radius, "mean free path of each channel, or one for all")
      .type_name("R G B");
  std::vector<std::string> units;
  for (const LengthUnit& unit : length_units) units.push_back(unit.name);
  command.add_option("--radius-unit", options->unit, "of --radius").one_of(units).show_default();
  command.add_choice("--radius-meaning", options->texture.meaning,
                     "1 / sigma_t, 1 / sigma_t_prime or 1 / sigma_tr");
  command.add_flag("--check", options->checks,
                   "solve the half-space without the table, and say how far its color is off");
  command.add_output_file(
      "-o,--output", options->output,
      "a material file with that color (.json), or of --texture the albedos (.exr)");
  add_common_options(command, options->common);
  command.footer(
      "Colors of .01 to .99 come out within .1 %. Some are out of reach: a surface that reflects\n"
      "keeps normal and diffuse from white, and furnace from black; these are refused.\n\n"
      "Examples: a warm white that looks like its hex code, as a material of .5 mm mean free path\n"
      "  lamina invert --color '#e8d0b8' --ior 1.4 --g .8 --radius .5 -o wax.json\n"
      "The color of light skin in a renderer that samples albedos from a map\n"
      "  lamina invert --texture face.png --definition diffuse -o albedo.exr");
  command.callback([options, command] {
    check_options(command, *options);
    if (options->texture.file.empty())
      run_color(*options);
    else
      run_texture(*options);
  });
}

}  // namespace lamina::cli
