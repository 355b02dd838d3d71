// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lamina/base/core/number_text.h"
#include "lamina/exchange/internal/burley_profile.h"
#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/formats.h"
#include "lamina/exchange/internal/shading_node.h"
#include "lamina/exchange/internal/thin_sheet.h"
#include "lamina/exchange/internal/walk_medium.h"
#include "lamina/exchange/misfit_json.h"
#include "lamina/layers/optics/fresnel.h"

// Values of the parameters of programs, to be typed in or set by a script; and of those whose files
// are text, such a file.
// Names are those of Arnold 7 (standard_surface), RenderMan 26 (PxrSurface), Unreal Engine 5
// (SubsurfaceProfileStruct) and Unity's HDRP 14 (Diffusion Profile, Lit).

namespace lamina::detail {
namespace {

struct Sheet {
  JsonOutput parameters = JsonOutput::object();
  std::vector<ChannelMisfit> misfits;
  std::vector<std::string> notes;
  /// The same as the program's own text: ending and text of a file; empty where there is none.
  std::pair<std::string, std::string> asset;
};

ExportedMaterial finished(const ExportInput& input, std::string_view format,
                          const std::string& target, const std::string& lengths, Sheet sheet) {
  sheet.notes.push_back("not tested in " + target + " itself");
  JsonOutput json = head_json(input, format);
  json["target"] = target;
  json["lengths"] = lengths;
  json["parameters"] = std::move(sheet.parameters);
  json["misfit"] = misfit_json(sheet.misfits);
  json["notes"] = sheet.notes;
  std::vector<ExportedFile> files = {
      {input.stem + "_" + std::string(format) + ".json", json.text(1) + "\n"}};
  if (const auto& [ending, text] = sheet.asset; !text.empty()) {
    std::vector<std::string> lines = head_lines(input, target);
    lines.push_back(lengths);
    for (std::string& line : misfit_lines(sheet.misfits)) lines.push_back(std::move(line));
    for (const std::string& note : sheet.notes) lines.push_back(note);
    files.push_back({input.stem + ending, comment(lines, "# ") + text});
  }
  return {.files = std::move(files),
          .notes = std::move(sheet.notes),
          .misfits = std::move(sheet.misfits),
          .refusal = {}};
}

double enters(const ExportInput& input) { return 1.0 - fresnel_diffuse(input.surface_ior); }

double perceptual_roughness(const ExportInput& input) { return std::sqrt(input.surface.roughness); }

/// Colors under a surface that lets only a part of diffuse light in.
std::vector<double> below_surface(std::span<const double> totals, double enters, double share = 1) {
  std::vector<double> colors;
  for (const double total : totals)
    colors.push_back(std::clamp(total / (enters * std::max(share, 1e-12)), 0.0, 1.0));
  return colors;
}

/// Lengths as the longest and their ratios to it.
struct ScaledLengths {
  double longest = 0.0;
  std::vector<double> ratios;
};

ScaledLengths scaled(std::span<const double> lengths) {
  ScaledLengths result{.longest = *std::ranges::max_element(lengths), .ratios = {}};
  for (const double length : lengths) result.ratios.push_back(length / result.longest);
  return result;
}

/// Both sides' colors with the share that goes through.
struct Sides {
  double through = 0.0;
  std::vector<double> reflected, transmitted;
};

Sides sides_of(const ExportInput& input, const WalkMedium& medium) {
  const double part = enters(input);
  Sides sides{.through = 0.5 * (1.0 + make_thin_sheet(*input.light, part).forward),
              .reflected = {},
              .transmitted = {}};
  sides.reflected = below_surface(medium.reflectance, part, 1.0 - sides.through);
  sides.transmitted = below_surface(medium.transmittance, part, sides.through);
  return sides;
}

/// Of light that leaves by Burley's profile, which screen-space shaders have.
Sheet burley_sheet(const ExportInput& input, const BurleyProfiles& burley) {
  Sheet sheet;
  sheet.misfits = channel_misfits(*input.light, burley.profile);
  return sheet;
}

}  // namespace

ExportedMaterial write_arnold(const ExportInput& input) {
  const WalkMedium medium = make_walk_medium(input, "arnold");
  const double mm_per_unit = input.options.mm_per_unit;
  ShadingNode node{.type = "standard_surface",
                   .name = input.stem,
                   .parameters = {{"specular", 1.0},
                                  {"specular_IOR", input.surface_ior},
                                  {"specular_roughness", perceptual_roughness(input)},
                                  {"thin_walled", medium.is_sheet()}}};
  const auto set = [&](const char* name, auto value) { node.parameters.push_back({name, value}); };
  Sheet sheet{.misfits = medium.misfits};
  if (medium.is_sheet()) {
    const Sides sides = sides_of(input, medium);
    set("base", 1.0);
    set("base_color", sides.reflected);
    set("subsurface", sides.through);
    set("subsurface_color", sides.transmitted);
    sheet.notes.emplace_back("thin-walled: the base reflects, subsurface transmits diffusely");
  } else {
    const ScaledLengths lengths = scaled(medium.mean_free_path);
    set("subsurface", 1.0);
    set("subsurface_type", NodeChoice{.name = "randomwalk", .place = 1});
    set("subsurface_color", below_surface(medium.reflectance, enters(input)));
    set("subsurface_radius", lengths.ratios);
    set("subsurface_scale", lengths.longest / mm_per_unit);
    set("subsurface_anisotropy", medium.g);
    sheet.notes.emplace_back(
        "Arnold's inversion of the color is not published: the color is the one that is to come "
        "out, less what the surface reflects");
  }
  sheet.parameters = node_json(node);
  sheet.asset = {".ass", arnold_text(node)};
  return finished(
      input, "arnold", "Arnold",
      "subsurface_radius times subsurface_scale is the mean free path in scene units of " +
          number_text(mm_per_unit) + " mm",
      std::move(sheet));
}

ExportedMaterial write_renderman(const ExportInput& input) {
  const WalkMedium medium = make_walk_medium(input, "renderman");
  ShadingNode node{.type = "PxrSurface",
                   .name = input.stem,
                   .parameters = {{"specularFresnelMode", NodeChoice{"Physical", 1}},
                                  {"specularIor", NodeGray{input.surface_ior}},
                                  {"specularRoughness", perceptual_roughness(input)}}};
  const auto set = [&](const char* name, auto value) { node.parameters.push_back({name, value}); };
  Sheet sheet{.misfits = medium.misfits};
  if (medium.is_sheet()) {
    const double part = enters(input);
    set("diffuseGain", 1.0);
    set("diffuseColor", below_surface(medium.reflectance, part));
    set("diffuseDoubleSided", true);
    set("diffuseTransmitGain", 1.0);
    set("diffuseTransmitColor", below_surface(medium.transmittance, part));
  } else {
    std::vector<double> diffuse_lengths;
    for (const Medium& of_channel : input.fit->media)
      diffuse_lengths.push_back(1.0 / std::max(sigma_tr(of_channel), 1e-9));
    const ScaledLengths lengths = scaled(diffuse_lengths);
    set("diffuseGain", 0.0);
    set("subsurfaceGain", 1.0);
    // The fifth of its models, after two dipoles, Burley's and several mean free paths.
    set("subsurfaceType", NodeChoice{.name = "Path Traced, exponential", .place = 4});
    set("subsurfaceColor", below_surface(medium.reflectance, enters(input)));
    set("subsurfaceDmfp", lengths.longest);
    set("subsurfaceDmfpColor", lengths.ratios);
    set("subsurfaceDirectionality", medium.g);
    set("unitLength", 1.0 / input.options.mm_per_unit);
    sheet.notes.emplace_back(
        "subsurfaceType 4 of the RIB is the path-traced exponential walk by the order in which the "
        "models are documented");
  }
  sheet.parameters = node_json(node);
  sheet.asset = {".rib", rib_text(node)};
  return finished(input, "renderman", "RenderMan",
                  "subsurfaceDmfp times its color is the diffuse mean free path 1/sigma_tr in mm, "
                  "as RenderMan's own table has it; unitLength is scene units per mm",
                  std::move(sheet));
}

ExportedMaterial write_unreal(const ExportInput& input) {
  const WalkMedium medium = make_walk_medium(input, "unreal");
  constexpr double mm_per_cm = 10.0;
  const double part = enters(input);
  if (medium.is_sheet()) {
    Sheet sheet{.parameters = {{"asset", "Material"},
                               {"ShadingModel", "Two Sided Foliage"},
                               {"TwoSided", true},
                               {"BaseColor", below_surface(medium.reflectance, part)},
                               {"SubsurfaceColor", below_surface(medium.transmittance, part)},
                               {"Roughness", perceptual_roughness(input)}},
                .misfits = medium.misfits,
                .notes = {}};
    return finished(input, "unreal", "Unreal Engine", "none", std::move(sheet));
  }
  const BurleyProfiles burley = fit_burley(*input.light);
  Sheet sheet = burley_sheet(input, burley);
  const std::vector<double> colors = below_surface(medium.reflectance, part);
  std::vector<double> paths;
  for (std::size_t c = 0; c < colors.size(); ++c)
    paths.push_back(burley.d[c] * burley_mean_free_path_scale(colors[c]) / mm_per_cm);
  const ScaledLengths lengths = scaled(paths);
  sheet.parameters = {{"asset", "SubsurfaceProfile"},
                      {"ShadingModel", "Subsurface Profile"},
                      {"bEnableBurley", true},
                      {"bEnableMeanFreePath", true},
                      {"SurfaceAlbedo", colors},
                      {"BaseColor", colors},
                      {"MeanFreePathColor", lengths.ratios},
                      {"MeanFreePathDistance", lengths.longest},
                      {"WorldUnitScale", input.options.mm_per_unit / mm_per_cm},
                      {"IOR", input.surface_ior},
                      {"Roughness", perceptual_roughness(input)},
                      {"LobeMix", 0.0},
                      {"Roughness0", 1.0},
                      {"Roughness1", 1.0}};
  sheet.notes.emplace_back(
      "the length makes Burley's profile of a perpendicular beam the nearest one; the engine's own "
      "factor between lengths may differ: compare WorldUnitScale by eye");
  return finished(input, "unreal", "Unreal Engine",
                  "MeanFreePathDistance times its color is in cm; bEnableMeanFreePath says that it "
                  "is the mean free path, not the diffuse one",
                  std::move(sheet));
}

ExportedMaterial write_unity_hdrp(const ExportInput& input) {
  const WalkMedium medium = make_walk_medium(input, "unity-hdrp");
  const double part = enters(input), smoothness = 1.0 - perceptual_roughness(input);
  constexpr double mm_per_m = 1000.0;
  const double meters_per_unit = input.options.mm_per_unit / mm_per_m;
  if (medium.is_sheet()) {
    Sheet sheet{.parameters = {{"materialType", "Translucent"},
                               {"baseColor", below_surface(medium.reflectance, part)},
                               {"transmissionTint", below_surface(medium.transmittance, part)},
                               {"smoothness", smoothness},
                               {"ior", input.surface_ior},
                               {"worldScale", meters_per_unit},
                               {"doubleSided", true}},
                .misfits = medium.misfits,
                .notes = {}};
    return finished(input, "unity-hdrp", "Unity's HDRP", "worldScale is meters per scene unit",
                    std::move(sheet));
  }
  const BurleyProfiles burley = fit_burley(*input.light);
  Sheet sheet = burley_sheet(input, burley);
  const ScaledLengths lengths = scaled(burley.d);
  sheet.parameters = {{"materialType", "Subsurface Scattering"},
                      {"baseColor", below_surface(medium.reflectance, part)},
                      {"scatteringDistance", lengths.ratios},
                      {"scatteringDistanceMultiplier", lengths.longest},
                      {"ior", input.surface_ior},
                      {"worldScale", meters_per_unit},
                      {"texturingMode", "Post-Scatter"},
                      {"smoothness", smoothness}};
  return finished(input, "unity-hdrp", "Unity's HDRP",
                  "scatteringDistance times its multiplier is d of Burley's profile in mm, no mean "
                  "free path; worldScale is meters per scene unit",
                  std::move(sheet));
}

}  // namespace lamina::detail
