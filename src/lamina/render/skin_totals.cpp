// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/skin_totals.h"

#include <cassert>
#include <variant>

#include "lamina/render/exact_totals.h"

namespace lamina {
namespace {

constexpr double least_total = 1e-9;

/// Whether all light that a method finds is that of radiative transfer.
bool is_exact(const Material& material, const RenderSettings& settings) {
  using Method = RenderSettings::Method;
  switch (settings.method) {
    case Method::random_walk:
    case Method::layered_bsdf:
      return true;
    case Method::texture_space:
      return takes_exact_totals(material, settings);
    default:
      return settings.profile == RenderSettings::Profile::exact ||
             takes_exact_totals(material, settings);
  }
}

}  // namespace

std::string_view name_of(SkinConstants constants) {
  switch (constants) {
    case SkinConstants::paper:
      return "paper";
    case SkinConstants::calibrated_diffusion:
      return "calibrated_diffusion";
    case SkinConstants::calibrated:
      break;
  }
  return "calibrated";
}

bool takes_exact_totals(const Material& material, const RenderSettings& settings) {
  return material.skin && are_for_exact_totals(material.skin->constants) &&
         settings.single_scattering == RenderSettings::SingleScattering::none;
}

Profile with_exact_totals(Profile profile, const Material& material) {
  assert(profile.per == ProfilePer::entered_flux);
  const std::vector<EnteredTotals> exact = exact_totals(material);
  for (std::size_t b = 0; b < profile.bands; ++b) {
    const auto scale = [&](std::vector<double>& values, double& total, double wanted) {
      if (!(total > least_total)) return;
      for (std::size_t i = b; i < values.size(); i += profile.bands) values[i] *= wanted / total;
      total = wanted;
    };
    scale(profile.reflectance_profile, profile.total_reflectance[b], exact[b].reflectance);
    scale(profile.transmittance_profile, profile.total_transmittance[b], exact[b].transmittance);
  }
  return profile;
}

std::vector<SkinTotals> skin_totals(const Scene& scene) {
  std::vector<SkinTotals> found;
  for (std::uint32_t i = 0; i < scene.materials.size(); ++i) {
    const auto* surface = std::get_if<SubsurfaceSurface>(&scene.materials[i].surface);
    if (surface && surface->material.skin)
      found.push_back(
          {i, surface->material.skin->constants, is_exact(surface->material, scene.render)});
  }
  return found;
}

std::string describe(const SkinTotals& totals, const Scene& scene) {
  std::string line = scene.materials[totals.material].name + ": skin with the constants \"" +
                     std::string(name_of(totals.constants)) + "\", totals by " +
                     (totals.is_exact ? "radiative transfer" : "diffusion");
  if (are_for_exact_totals(totals.constants) && !totals.is_exact)
    line += ": brighter than the skin that they were fitted to, for light scattered once is added";
  if (totals.constants == SkinConstants::calibrated_diffusion && totals.is_exact)
    line += ": darker than the skin that they were fitted to by diffusion";
  return line;
}

}  // namespace lamina
