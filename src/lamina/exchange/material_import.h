// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/progress.h"
#include "lamina/exchange/medium_fit/homogeneous_fit.h"
#include "lamina/layers/materials/material.h"

namespace lamina {

/// Program or format whose parameters a material is made from.
enum class ImportSource {
  openpbr,     ///< OpenPBR 1.1.1: subsurface color and radius, by the definition in its text
  principled,  ///< Blender's Principled BSDF: by the walk of Cycles
  arnold       ///< Arnold's standard_surface: its color by the definition, below its walk
};

template <>
inline constexpr auto enum_names<ImportSource> =
    std::to_array<EnumName<ImportSource>>({{"openpbr", ImportSource::openpbr},
                                           {"principled", ImportSource::principled},
                                           {"arnold", ImportSource::arnold}});

/// Versions of Blender that mean different things by the same numbers.
enum class BlenderRules {
  blender_3,   ///< 3.0 to 3.6, Random Walk (Fixed Radius)
  blender_4,   ///< 4.0 to 5.1, Random Walk; 5.2, Random Walk (Legacy)
  blender_5_2  ///< 5.2 and later, Random Walk
};

template <>
inline constexpr auto enum_names<BlenderRules> =
    std::to_array<EnumName<BlenderRules>>({{"3", BlenderRules::blender_3},
                                           {"4", BlenderRules::blender_4},
                                           {"5.2", BlenderRules::blender_5_2}});

/// Parameters as the other program has them.
struct ImportedParameters {
  ImportSource source = ImportSource::openpbr;
  BlenderRules blender = BlenderRules::blender_4;  ///< of principled
  std::array<double, 3> color{0.8, 0.8, 0.8};      ///< linear, in [0, 1]
  std::array<double, 3> radius{1.0, 1.0, 1.0};     ///< [units of its scene], > 0
  double scale = 1.0;                              ///< of the radius, > 0
  double g = 0.0;                                  ///< in [0, 0.9]
  double ior = 1.5;                                ///< of the surface, in [1, 1.6]
  double roughness = 0.3;    ///< the slider's: square root of alpha, in [0, 1]
  double mm_per_unit = 1.0;  ///< of its scene, > 0
};

struct ImportedMaterial {
  Material material;  ///< a half-space of R, G and B under a refracting boundary of GGX facets
  /// How far the light of the material is from that of the walk that the other program makes.
  std::vector<ChannelMisfit> misfits;
  std::string definition;  ///< by what rule the color is one
  std::vector<std::string> notes;
};

/// The material that looks like one of another renderer.
///
/// OpenPBR's medium lies below the boundary of its index: its albedo is that with which the color
/// comes out (SubsurfaceColor), and its radius is the mean free path. Walks of the
/// others are below a boundary that does not refract; for these the medium below a refracting one
/// is found that returns as much light and whose profile is nearest, by radiative transfer.
///
/// @throws InvalidInput naming the number that is out of its range; Interrupted.
[[nodiscard]] ImportedMaterial import_material(const ImportedParameters& parameters,
                                               const Progress& progress = {});

}  // namespace lamina
