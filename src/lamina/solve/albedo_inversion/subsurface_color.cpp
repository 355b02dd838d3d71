// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/albedo_inversion/subsurface_color.h"

#include <algorithm>
#include <cassert>

#include "lamina/solve/albedo_inversion/renderer_albedos.h"

namespace lamina {
namespace {

constexpr double whitest = 0.999999;

/// The half-spaces of a definition, of the numbers of a look that the table has.
HalfSpaceColor half_spaces(SubsurfaceColor whose, HalfSpaceLook look) {
  look.ior = std::clamp(look.ior, lowest_look_ior, highest_look_ior);
  look.g = std::clamp(look.g, lowest_look_g, highest_look_g);
  look.definition = whose == SubsurfaceColor::openpbr ? ColorDefinition::openpbr  //
                                                      : ColorDefinition::diffuse;
  return HalfSpaceColor(look);
}

}  // namespace

std::string_view definition_text(SubsurfaceColor whose) {
  switch (whose) {
    case SubsurfaceColor::openpbr:
      return "by the definition of OpenPBR 1.1.1: along the normal under even light, the color is "
             "what leaves over what gets in";
    case SubsurfaceColor::standard_surface:
      return "by Autodesk Standard Surface: under even light, the color is what leaves over what "
             "the specular layer lets in";
    case SubsurfaceColor::khr_scatter:
      break;
  }
  return "by KHR_materials_volume_scatter: the albedo of single scattering by the formula that it "
         "prints";
}

double subsurface_albedo(SubsurfaceColor whose, double color, const HalfSpaceLook& look) {
  assert(0.0 <= color && color <= 1.0);
  if (whose == SubsurfaceColor::khr_scatter)
    return std::min(van_de_hulst_albedo(color, 0.0), whitest);
  const HalfSpaceColor half_space = half_spaces(whose, look);
  // All that gets in is what a white half-space returns.
  return std::min(half_space.nearest_albedo(color * half_space.brightest()), whitest);
}

double subsurface_color(SubsurfaceColor whose, double albedo, const HalfSpaceLook& look) {
  assert(0.0 <= albedo && albedo <= 1.0);
  if (whose == SubsurfaceColor::khr_scatter) return van_de_hulst_color(albedo, 0.0);
  const HalfSpaceColor half_space = half_spaces(whose, look);
  return half_space.color(albedo) / half_space.brightest();
}

}  // namespace lamina
