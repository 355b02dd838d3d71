// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/export_format.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "lamina/core/error.h"
#include "lamina/core/number_text.h"
#include "lamina/exchange/internal/formats.h"
#include "lamina/io/nearest_name.h"

namespace lamina {
namespace {

/// To add a format: write its function in internal/NAME_format.cpp, declare it in
/// internal/formats.h, and give it a row.
constexpr std::array formats{
    ExportFormat{
        .name = "gaussians",
        .about = "sums of Gaussians and a separable kernel for screen and texture space, JSON",
        .ending = ".json",
        .channels = ExportChannels::rgb,
        .needs = ExportNeeds::light,
        .write = detail::write_gaussians},
    ExportFormat{.name = "mcml",
                 .about = "the layers as an input file of MCML 1.2, one run per band",
                 .ending = ".mci",
                 .channels = ExportChannels::bands,
                 .needs = ExportNeeds::layers,
                 .write = detail::write_mcml},
};

void check(const ExportOptions& options) {
  if (!(options.mm_per_unit >= 1e-9 && options.mm_per_unit <= 1e9))
    throw InvalidInput("mm_per_unit must lie in [1e-9, 1e9], but is " +
                       number_text(options.mm_per_unit));
  if (options.gaussians < 1 || options.gaussians > 40)
    throw InvalidInput("gaussians must lie in [1, 40], but is " +
                       std::to_string(options.gaussians));
}

}  // namespace

std::span<const ExportFormat> export_formats() { return formats; }

const ExportFormat& find_export_format(std::string_view name) {
  const auto* const found = std::ranges::find_if(
      formats, [&](const ExportFormat& format) { return format.name == name; });
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
                    .stem = file_stem(material.name),
                    .options = options};
  struct Worked {
    ChannelLight light;
    std::optional<HomogeneousFit> fit;
  };
  std::map<ExportChannels, Worked> worked;
  std::vector<ExportedMaterial> result;
  for (const ExportFormat* const format : formats_wanted) {
    const ExportChannels kind = options.channels.value_or(format->channels);
    input.channels = make_channels(material.bands, kind);
    input.light.reset();
    input.fit.reset();
    if (format->needs != ExportNeeds::layers) {
      if (!worked.contains(kind))
        worked[kind].light = channel_light(material, input.stacks, kind, options.progress);
      input.light = worked[kind].light;
    }
    if (format->needs == ExportNeeds::medium) {
      std::optional<HomogeneousFit>& fit = worked[kind].fit;
      if (!fit)
        fit = fit_homogeneous(worked[kind].light, input.stacks,
                              {.g = options.g,
                               .ior = options.ior,
                               .goal = options.goal,
                               .progress = options.progress});
      input.fit = fit;
    }
    result.push_back(format->write(input));
    if (input.fit)
      result.back().notes.insert(result.back().notes.end(), input.fit->notes.begin(),
                                 input.fit->notes.end());
  }
  return result;
}

std::string file_stem(std::string_view material) {
  std::string stem;
  for (const char c : material) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '_' || c == '-';
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
