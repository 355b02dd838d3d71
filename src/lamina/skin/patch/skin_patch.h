// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/base/image/image.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/base/spectrum/band_set.h"
#include "lamina/skin/maps/skin_maps.h"
#include "lamina/skin/patch/material_texels.h"
#include "lamina/solve/scattering/heterogeneous/heterogeneous_transport.h"

namespace lamina {

/// A flat piece of skin, or of another material, under a pattern of light. Beyond its edges both go
/// on as their mirror image.
struct SkinPatch {
  std::string name;
  int width = 0, height = 0;  ///< texels
  double mm_per_texel = 0.1;
  BandSet bands = default_spectral_bands();  ///< those of `material`, if there is one
  SkinMaps skin;                             ///< maps of any size
  std::optional<MappedMaterial> material;    ///< in place of skin
  Image light;         ///< [y][x] irradiance that arrives, one channel, of the patch's size
  double theta = 0.0;  ///< angle of incidence [rad], in [0, pi/2)
  OperatorTotals totals = OperatorTotals::radiative_transfer_profile;
  TransportOptions transport;
  std::vector<int> interlayer_bounces;  ///< [band]; empty: those of `transport`
  ProfileAt profile = ProfileAt::both;
  /// [y][x] by band, of the patch's size: a texture of the reflectances that skin is to have in
  /// even light. What leaves is multiplied by them over those that it has. Empty: none
  Image albedo;
  std::vector<std::string> warnings;
};

/// How one band was solved.
struct SkinPatchBand {
  double mean_reflectance = 0.0;  ///< exitance over irradiance, both summed over the patch
  double fit_error = 0.0;         ///< largest of the tables over the absorptions of the maps
  int interlayer_bounces = 0;
  double last_bounce = 0.0;  ///< as in TransportResult
};

struct SkinPatchResult {
  /// Exitance [y][x] by band, "400nm" .., in the unit of the irradiance; then "R", "G", "B" in
  /// linear sRGB under D65. Of a material in RGB "R", "G", "B". Where light comes through also
  /// "transmitted.400nm" .. and "transmitted.R" ..
  Image image;
  std::vector<SkinPatchBand> bands;
  std::vector<StackTables> tables;                      ///< [band]
  double table_seconds = 0.0, transport_seconds = 0.0;  ///< summed over threads
};

/// The light that leaves the patch; mirror reflection is left out.
///
/// @param cache  keeps the tables; absent: none.
/// @throws Interrupted if progress asks to stop; InvalidInput as mapped_stack,
///         make_heterogeneous_layers.
[[nodiscard]] SkinPatchResult render_skin_patch(const SkinPatch& patch,
                                                const std::optional<DiskCache>& cache = {},
                                                const Progress& progress = {});

/// The material of a patch, with the numbers that vary at each of its texels.
struct PatchMaterial {
  Material material;
  std::vector<NumberTexels> maps;
};
[[nodiscard]] PatchMaterial material_of(const SkinPatch& patch);

}  // namespace lamina
