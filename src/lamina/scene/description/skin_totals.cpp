// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/skin_totals.h"

#include <variant>

#include "lamina/scene/description/materials_in_use.h"

namespace lamina {
namespace {

/// Whether all light that a method finds is that of radiative transfer.
bool has_transfer_totals(const Material& material, const RenderSettings& settings) {
  const auto& method = settings.method;
  if (!method.is_open() && method->solves_transfer) return true;
  if (takes_material_totals(material, settings)) return true;
  return (method.is_open() || method->uses_profile) &&
         profile_of(settings) == RenderSettings::Profile::radiative_transfer;
}

}  // namespace

bool takes_material_totals(const Material& material, const RenderSettings& settings) {
  return material.skin && are_for_transfer_totals(material.skin->constants) &&
         settings.single_scattering == RenderSettings::SingleScattering::none;
}

std::vector<SkinTotals> skin_totals(const Scene& scene) {
  std::vector<SkinTotals> found;
  for (const std::uint32_t i : translucent_materials_in_use(scene)) {
    const Material& material = std::get<SubsurfaceSurface>(scene.materials[i].surface).material;
    if (material.skin)
      found.push_back({i, material.skin->constants, has_transfer_totals(material, scene.render)});
  }
  return found;
}

std::string describe_skin_totals(const SkinTotals& totals, const Scene& scene) {
  std::string line = scene.materials[totals.material].name + ": skin with the constants \"" +
                     std::string(name_of(totals.constants)) + "\", totals by " +
                     (totals.by_transfer ? "radiative transfer" : "diffusion");
  if (are_for_transfer_totals(totals.constants) && !totals.by_transfer)
    line += ": brighter than the skin that they were fitted to, for light scattered once is added";
  if (totals.constants == SkinConstants::calibrated_diffusion && totals.by_transfer)
    line += ": darker than the skin that they were fitted to by diffusion";
  return line;
}

}  // namespace lamina
