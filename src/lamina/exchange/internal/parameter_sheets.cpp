// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lamina/core/number_text.h"
#include "lamina/exchange/internal/burley_profile.h"
#include "lamina/exchange/internal/format_text.h"
#include "lamina/exchange/internal/formats.h"
#include "lamina/exchange/internal/thin_sheet.h"
#include "lamina/exchange/internal/walk_medium.h"
#include "lamina/exchange/misfit_json.h"
#include "lamina/optics/fresnel.h"

// Values of the parameters of programs whose files are not text: to be typed in or set by a script.
// Names are those of Arnold 7 (standard_surface), RenderMan 26 (PxrSurface), Unreal Engine 5
// (SubsurfaceProfileStruct) and Unity's HDRP 14 (Diffusion Profile, Lit).

namespace lamina::detail {
namespace {

struct Sheet {
  JsonOutput parameters = JsonOutput::object();
  std::vector<ChannelMisfit> misfits;
  std::vector<std::string> notes;
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
  return {.files = {{input.stem + "_" + std::string(format) + ".json", json.text(1) + "\n"}},
          .notes = std::move(sheet.notes),
          .misfits = std::move(sheet.misfits),
          .refusal = {}};
}

double enters(const ExportInput& input) { return 1.0 - fresnel_diffuse(input.surface_ior); }

double perceptual_roughness(const ExportInput& input) {
  return std::sqrt(input.stacks.front().layers().front().top.roughness);
}

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
  Sheet sheet{.parameters = {{"node", "standard_surface"},
                             {"specular", 1.0},
                             {"specular_IOR", input.surface_ior},
                             {"specular_roughness", perceptual_roughness(input)},
                             {"thin_walled", medium.is_sheet()}},
              .misfits = medium.misfits,
              .notes = {}};
  if (medium.is_sheet()) {
    const Sides sides = sides_of(input, medium);
    sheet.parameters["base"] = 1.0;
    sheet.parameters["base_color"] = sides.reflected;
    sheet.parameters["subsurface"] = sides.through;
    sheet.parameters["subsurface_color"] = sides.transmitted;
    sheet.notes.emplace_back("thin-walled: the base reflects, subsurface transmits diffusely");
  } else {
    const ScaledLengths lengths = scaled(medium.mean_free_path);
    sheet.parameters["subsurface"] = 1.0;
    sheet.parameters["subsurface_type"] = "randomwalk";
    sheet.parameters["subsurface_color"] = below_surface(medium.reflectance, enters(input));
    sheet.parameters["subsurface_radius"] = lengths.ratios;
    sheet.parameters["subsurface_scale"] = lengths.longest / mm_per_unit;
    sheet.parameters["subsurface_anisotropy"] = medium.g;
    sheet.notes.emplace_back(
        "Arnold's inversion of the color is not published: the color is the one that is to come "
        "out, less what the surface reflects");
  }
  return finished(
      input, "arnold", "Arnold",
      "subsurface_radius times subsurface_scale is the mean free path in scene units of " +
          number_text(mm_per_unit) + " mm",
      std::move(sheet));
}

ExportedMaterial write_renderman(const ExportInput& input) {
  const WalkMedium medium = make_walk_medium(input, "renderman");
  Sheet sheet{.parameters = {{"node", "PxrSurface"},
                             {"specularFresnelMode", "Physical"},
                             {"specularIor", input.surface_ior},
                             {"specularRoughness", perceptual_roughness(input)}},
              .misfits = medium.misfits,
              .notes = {}};
  if (medium.is_sheet()) {
    const double part = enters(input);
    sheet.parameters["diffuseGain"] = 1.0;
    sheet.parameters["diffuseColor"] = below_surface(medium.reflectance, part);
    sheet.parameters["diffuseDoubleSided"] = true;
    sheet.parameters["diffuseTransmitGain"] = 1.0;
    sheet.parameters["diffuseTransmitColor"] = below_surface(medium.transmittance, part);
  } else {
    std::vector<double> diffuse_lengths;
    for (const Medium& of_channel : input.fit->media)
      diffuse_lengths.push_back(1.0 / std::max(sigma_tr(of_channel), 1e-9));
    const ScaledLengths lengths = scaled(diffuse_lengths);
    sheet.parameters["diffuseGain"] = 0.0;
    sheet.parameters["subsurfaceGain"] = 1.0;
    sheet.parameters["subsurfaceType"] = "Path Traced, exponential";
    sheet.parameters["subsurfaceColor"] = below_surface(medium.reflectance, enters(input));
    sheet.parameters["subsurfaceDmfp"] = lengths.longest;
    sheet.parameters["subsurfaceDmfpColor"] = lengths.ratios;
    sheet.parameters["subsurfaceDirectionality"] = medium.g;
    sheet.parameters["unitLength"] = 1.0 / input.options.mm_per_unit;
  }
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
