// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/material_import.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/exchange/medium_fit/channel_light.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/albedo_inversion/half_space_color.h"
#include "lamina/solve/albedo_inversion/renderer_albedos.h"
#include "lamina/solve/albedo_inversion/subsurface_color.h"

namespace lamina {
namespace {

constexpr std::size_t channels = 3;
constexpr const char* channel_names[channels] = {"R", "G", "B"};

void require(double value, double low, double high, const std::string& name) {
  if (!(low <= value && value <= high))
    throw InvalidInput(name + " must lie in [" + number_text(low) + ", " + number_text(high) +
                       "], but is " + number_text(value));
}

void check(const ImportedParameters& p) {
  constexpr double shortest = 1e-9, longest = 1e9;
  for (std::size_t c = 0; c < channels; ++c) {
    require(p.color[c], 0.0, 1.0, std::string("color ") + channel_names[c]);
    if (p.radius[c] == 0.0)
      throw InvalidInput(std::string("radius ") + channel_names[c] +
                         " must be > 0, but is 0: light that does not travel is that of a matte "
                         "surface, \"diffuse\" in a scene");
    require(p.radius[c], shortest, longest, std::string("radius ") + channel_names[c]);
  }
  require(p.scale, shortest, longest, "scale");
  require(p.mm_per_unit, shortest, longest, "mm_per_unit");
  require(p.g, 0.0, 0.9, "g");
  require(p.ior, lowest_look_ior, highest_look_ior, "ior");
  require(p.roughness, 0.0, 1.0, "roughness");
}

/// The mean over a hemisphere of light that leaves, of Blender 3's factor 1 - (1 - cos)^5 / 2.
constexpr double burley_exit = 1.0 - 1.0 / 42.0;

/// The retro-reflection of Burley's diffuse lobe in even light, per color.
double burley_retro(double roughness) {
  constexpr int steps = 24;
  const auto cosine = [](int i) { return (i + 0.5) / steps; };
  double sum = 0.0;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j)
      for (int k = 0; k < steps; ++k) {
        const double v = cosine(i), l = cosine(j);
        const double f_v = std::pow(1.0 - v, 5.0), f_l = std::pow(1.0 - l, 5.0);
        const double phi = std::numbers::pi * cosine(k);
        const double rr =
            roughness * (1.0 + v * l + std::sqrt((1 - v * v) * (1 - l * l)) * std::cos(phi));
        sum += 4.0 * v * l * rr * (f_l + f_v + f_l * f_v * (rr - 1.0));
      }
  return sum / (static_cast<double>(steps) * steps * steps);
}

/// What a half-space returns where paths enter along refracted directions, over the same where
/// they enter evenly: Hapke's approximation of the H function, by similarity.
double refracted_entry(double albedo, double g, double ior) {
  const double gamma = std::sqrt((1.0 - albedo) / (1.0 - g * albedo));
  const auto returned = [&](double cosine) {
    return 1.0 - gamma * (1.0 + 2.0 * cosine) / (1.0 + 2.0 * cosine * gamma);
  };
  constexpr int steps = 100;
  double even = 0.0, refracted = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double cosine = (i + 0.5) / steps;
    even += cosine * returned(cosine);
    refracted += cosine * returned(std::sqrt(1.0 - (1.0 - cosine * cosine) / (ior * ior)));
  }
  return even > 0.0 ? refracted / even : 1.0;
}

/// A walk below a boundary that does not refract, one channel.
struct Walk {
  double total = 0.0;           ///< of diffuse light, under the surface's reflection
  double mean_free_path = 0.0;  ///< [mm]
};

Walk walk_of(const ImportedParameters& p, std::size_t channel) {
  const double length = p.radius[channel] * p.scale * p.mm_per_unit, color = p.color[channel];
  const double enters = 1.0 - fresnel_diffuse(p.ior);
  if (p.source == ImportSource::arnold) return {.total = enters * color, .mean_free_path = length};
  const HalfSpaceColor matched({.ior = 1.0, .g = p.g, .definition = ColorDefinition::diffuse});
  const bool is_new = p.blender == BlenderRules::blender_5_2;
  const double albedo = is_new ? van_de_hulst_albedo(color, p.g) : wrenninge_albedo(color, p.g);
  // Up to 5.1 the kernel takes a 4 pi-th of the radius for the reduced mean free path.
  Walk walk{.mean_free_path = is_new ? length : length / (4.0 * std::numbers::pi) * (1.0 - p.g)};
  walk.total = p.blender == BlenderRules::blender_3
                   ? burley_exit * matched.color(albedo) + burley_retro(p.roughness) * color
                   : enters * refracted_entry(albedo, p.g, p.ior) * matched.color(albedo);
  return walk;
}

std::string definition_of(const ImportedParameters& p) {
  if (p.source == ImportSource::openpbr)
    return std::string(definition_text(SubsurfaceColor::openpbr));
  if (p.source == ImportSource::arnold)
    return std::string(definition_text(SubsurfaceColor::standard_surface));
  return "by Cycles: the albedo of single scattering by its formula, of a walk below a boundary "
         "that does not refract";
}

std::string source_text(const ImportedParameters& p) {
  std::string text = "lamina import --from " + std::string(name_of(p.source));
  if (p.source == ImportSource::principled) text += " --blender " + std::string(name_of(p.blender));
  const auto numbers = [&](const std::string& name, const std::array<double, channels>& values) {
    text += " --" + name;
    for (const double value : values) text += " " + number_text(value);
  };
  numbers("color", p.color);
  numbers("radius", p.radius);
  return text + " --scale " + number_text(p.scale) + " --g " + number_text(p.g) + " --ior " +
         number_text(p.ior) + " --roughness " + number_text(p.roughness) + " --mm-per-unit " +
         number_text(p.mm_per_unit);
}

}  // namespace

ImportedMaterial import_material(const ImportedParameters& p, const Progress& progress) {
  check(p);
  ImportedMaterial result;
  const Interface top{.roughness = p.roughness * p.roughness,
                      .distribution = MicrofacetDistribution::ggx};
  std::array<Medium, channels> media;
  if (p.source == ImportSource::openpbr) {
    const HalfSpaceLook look{.ior = p.ior, .g = p.g, .top = top};
    for (std::size_t c = 0; c < channels; ++c)
      media[c] = medium_of(look, subsurface_albedo(SubsurfaceColor::openpbr, p.color[c], look),
                           p.radius[c] * p.scale * p.mm_per_unit);
  } else {
    const HalfSpaceLook matched{
        .ior = 1.0, .g = p.g, .top = {}, .definition = ColorDefinition::diffuse};
    const HalfSpaceColor color(matched);
    constexpr double whitest = 0.999999;  // so that something is absorbed
    for (std::size_t c = 0; c < channels; ++c) {
      const Walk walk = walk_of(p, c);
      media[c] = medium_of(matched, std::clamp(color.nearest_albedo(walk.total), 1e-3, whitest),
                           walk.mean_free_path);
    }
    if (p.ior > 1.0) {
      const Material walks = half_space_material(media, {});
      const std::vector<LayerStack> stacks = layer_stacks(walks);
      const ChannelLight light = channel_light(walks, stacks, ExportChannels::rgb, progress);
      const HomogeneousFit fit =
          fit_homogeneous(light, stacks, {.g = p.g, .ior = p.ior, .progress = progress});
      std::ranges::copy(fit.media, media.begin());
      result.misfits = fit.misfits;
      result.notes = fit.notes;
    }
    if (p.source == ImportSource::arnold)
      result.notes.emplace_back("Arnold's inversion of the color is not published");
  }
  result.definition = definition_of(p);
  result.material = half_space_material(media, top);
  result.material.name = "imported";
  result.material.source = source_text(p);
  return result;
}

}  // namespace lamina
