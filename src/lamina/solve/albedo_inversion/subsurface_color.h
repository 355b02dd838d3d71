// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "lamina/solve/albedo_inversion/half_space_color.h"

namespace lamina {

/// The format whose `subsurface_color` or multi-scatter color a color is.
enum class SubsurfaceColor {
  openpbr,           ///< the definition in the text of [OpenPBR] 1.1.1, section Subsurface
  standard_surface,  ///< [StandardSurface]: below the layer of specular reflection
  khr_scatter        ///< KHR_materials_volume_scatter: by the formula that it prints
};

/// The definition of a format in words, as results print it.
[[nodiscard]] std::string_view definition_text(SubsurfaceColor whose);

/// The single-scattering albedo that a color means by the definition of its format.
///
/// OpenPBR: along the normal under even light, what leaves is the color times what gets in,
/// E_multi-scatter = (1 - E_spec) C. Standard Surface: the same of all directions, as its layer of
/// specular reflection passes 1 - reflectance on to the closure below. Both for a half-space, by
/// radiative transfer. KHR_materials_volume_scatter: [KullaConty2017], of whatever index and g.
///
/// @param color  linear, in [0, 1]; white is .999999, so that something is absorbed
/// @param look   index, g and roughness of the half-space; its definition is not read. Numbers
///               beyond what HalfSpaceColor has stand for the nearest ones that it has.
[[nodiscard]] double subsurface_albedo(SubsurfaceColor whose, double color,
                                       const HalfSpaceLook& look);

/// The color that an albedo has by the definition of a format: the inverse.
/// @param albedo  of single scattering, in [0, 1]
[[nodiscard]] double subsurface_color(SubsurfaceColor whose, double albedo,
                                      const HalfSpaceLook& look);

}  // namespace lamina
