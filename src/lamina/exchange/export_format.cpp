// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/export_format.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/nearest_name.h"
#include "lamina/exchange/internal/formats.h"

namespace lamina {
namespace {

// To add a format: docs/architecture.md, "An export format".
constexpr std::array formats{
    ExportFormat{.name = "gaussians",
                 .about = "sums of Gaussians and a separable kernel for screen space, as JSON",
                 .ending = ".json",
                 .needs = ExportNeeds::light,
                 .write = detail::write_gaussians},
    ExportFormat{.name = "table",
                 .about = "profile and BSDF on grids, as NPZ, CSV and EXR",
                 .ending = ".npz",
                 .needs = ExportNeeds::light,
                 .write = detail::write_table},
    ExportFormat{
        .name = "mixture",
        .about = "three media, one taken at random per path, that make the profile, as JSON",
        .ending = ".json",
        .write = detail::write_mixture},
    ExportFormat{
        .name = "pbrt-v4",
        .about = "a scene fragment: medium and boundary, subsurface, from afar, the layers",
        .ending = ".pbrt",
        .write = detail::write_pbrt},
    ExportFormat{.name = "mitsuba3",
                 .about = "a scene fragment for Mitsuba 3: medium and boundary, as XML",
                 .ending = ".xml",
                 .write = detail::write_mitsuba3},
    ExportFormat{.name = "openpbr",
                 .alias = "materialx",
                 .about = "OpenPBR 1.1.1 in MaterialX: subsurface, or thin walls, as .mtlx",
                 .ending = ".mtlx",
                 .write = detail::write_openpbr},
    ExportFormat{.name = "blender",
                 .about = "a Python script that makes a material, and JSON for lamina's add-on",
                 .ending = ".py",
                 .needs = ExportNeeds::walk,
                 .write = detail::write_blender},
    ExportFormat{.name = "gltf",
                 .about = "a GLB, or a copy of one, with reflected and transmitted color",
                 .ending = ".glb",
                 .write = detail::write_gltf},
    ExportFormat{.name = "arnold",
                 .about = "parameters of Arnold's standard_surface, as JSON",
                 .ending = ".json",
                 .needs = ExportNeeds::walk,
                 .write = detail::write_arnold},
    ExportFormat{.name = "renderman",
                 .about = "parameters of RenderMan's PxrSurface, as JSON",
                 .ending = ".json",
                 .needs = ExportNeeds::walk,
                 .write = detail::write_renderman},
    ExportFormat{.name = "unreal",
                 .about = "a subsurface profile of Unreal Engine 5, as JSON",
                 .ending = ".json",
                 .needs = ExportNeeds::walk,
                 .write = detail::write_unreal},
    ExportFormat{.name = "unity-hdrp",
                 .about = "a diffusion profile of Unity's HDRP, as JSON",
                 .ending = ".json",
                 .needs = ExportNeeds::walk,
                 .write = detail::write_unity_hdrp},
    ExportFormat{.name = "mcml",
                 .about = "the layers as an input file of MCML 1.2, one run per band",
                 .ending = ".mci",
                 .channels = ExportChannels::bands,
                 .needs = ExportNeeds::layers,
                 .write = detail::write_mcml},
    ExportFormat{.name = "mcx",
                 .about = "the layers as JSON for MCX, one file per band, and for PyXOpto",
                 .ending = ".json",
                 .channels = ExportChannels::bands,
                 .needs = ExportNeeds::layers,
                 .write = detail::write_mcx},
};

void check(const ExportOptions& options) {
  if (!(options.mm_per_unit >= 1e-9 && options.mm_per_unit <= 1e9))
    throw InvalidInput("mm_per_unit must lie in [1e-9, 1e9], but is " +
                       number_text(options.mm_per_unit));
  if (options.gaussians < 1 || options.gaussians > 40)
    throw InvalidInput("gaussians must lie in [1, 40], but is " +
                       std::to_string(options.gaussians));
}

/// What formats of some channels need, as far as one has asked for it.
struct WorkedOut {
  std::optional<ChannelLight> light;
  std::optional<HomogeneousFit> fit, walk;
};

double mean_over(std::span<const LayerStack> stacks, double (*number)(const LayerStack&)) {
  const double first = number(stacks.front());  // so that equal numbers have themselves as mean
  double sum = 0.0;
  for (const LayerStack& stack : stacks) sum += number(stack) - first;
  return first + sum / static_cast<double>(stacks.size());
}

double mean_ior_above(std::span<const LayerStack> stacks) {
  return mean_over(stacks, [](const LayerStack& stack) { return stack.ior_above(); });
}

/// The medium for a renderer's walk. Mean cosines are those that all such renderers take.
HomogeneousFit fit_walk(const ChannelLight& light, std::span<const LayerStack> stacks,
                        const ExportOptions& options) {
  constexpr double highest_g = 0.9;
  std::optional<double> g = options.g;
  if (!g && stacks.front().layers().size() == 1)
    g = std::clamp(mean_over(stacks, [](const auto& s) { return s.layers().front().medium.g; }),
                   0.0, highest_g);
  return fit_homogeneous(
      light, stacks,
      {.g = g, .ior = mean_ior_above(stacks), .goal = options.goal, .progress = options.progress});
}

/// Puts into the input what a format needs.
void work_out(const ExportFormat& format, ExportChannels kind, WorkedOut& known,
              ExportInput& input) {
  const ExportOptions& options = input.options;
  input.channels = make_channels(input.material.bands, kind);
  input.light.reset();
  input.fit.reset();
  if (format.needs == ExportNeeds::layers) return;
  if (!known.light)
    known.light = channel_light(input.material, input.stacks, kind, options.progress);
  input.light = known.light;
  if (format.needs == ExportNeeds::walk && !known.light->transmits) {
    if (!known.walk) known.walk = fit_walk(*known.light, input.stacks, options);
    known.walk->top = input.surface;
    input.fit = known.walk;
  }
  if (format.needs != ExportNeeds::medium) return;
  if (!known.fit)
    known.fit = fit_homogeneous(
        *known.light, input.stacks,
        {.g = options.g, .ior = options.ior, .goal = options.goal, .progress = options.progress});
  known.fit->top = input.surface;
  input.fit = known.fit;
}

}  // namespace

std::span<const ExportFormat> export_formats() { return formats; }

const ExportFormat& find_export_format(std::string_view name) {
  const auto* const found = std::ranges::find_if(formats, [&](const ExportFormat& format) {
    return format.name == name || (!format.alias.empty() && format.alias == name);
  });
  if (found != formats.end()) return *found;
  std::vector<std::string_view> names;
  for (const ExportFormat& format : formats) names.push_back(format.name);
  throw InvalidInput("there is no format \"" + std::string(name) + "\"" +
                     did_you_mean(name, names));
}

std::vector<ExportedMaterial> export_material(const Material& material,
                                              std::span<const ExportFormat* const> formats_wanted,
                                              const ExportOptions& options) {
  check(options);
  ExportInput input{.material = material,
                    .stacks = layer_stacks(material),
                    .surface = specular_top(material),
                    .stem = file_stem(material.name),
                    .options = options};
  input.surface_ior = options.ior.value_or(mean_over(input.stacks, [](const auto& s) {
    return s.layers().front().medium.ior;
  })) / mean_ior_above(input.stacks);
  std::map<ExportChannels, WorkedOut> worked_out;
  std::vector<ExportedMaterial> result;
  for (const ExportFormat* const format : formats_wanted) {
    try {
      const ExportChannels kind = options.channels.value_or(format->channels);
      work_out(*format, kind, worked_out[kind], input);
      result.push_back(format->write(input));
      if (input.fit)
        result.back().notes.insert(result.back().notes.end(), input.fit->notes.begin(),
                                   input.fit->notes.end());
    } catch (const InvalidInput& error) {
      if (!options.skips_refused) throw;
      result.push_back({.refusal = error.what()});
    }
  }
  return result;
}

std::string file_stem(std::string_view material) {
  std::string stem;
  for (const char c : material) {
    // A name that begins with '-' would be an option, and comments of XML hold no "--".
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '_' ||
                          (c == '-' && !stem.empty() && stem.back() != '-');
    if (is_plain)
      stem += c;
    else if (!stem.empty() && stem.back() != '_')
      stem += '_';
  }
  constexpr std::size_t longest = 100;
  stem.resize(std::min(stem.size(), longest));
  return stem.empty() ? "material" : stem;
}

}  // namespace lamina
