// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/progress.h"
#include "lamina/base/image/image.h"
#include "lamina/layers/materials/skin.h"
#include "lamina/skin/acquire/calibration/pixel_mask.h"
#include "lamina/skin/fit/skin/skin_population.h"
#include "lamina/solve/reflectance/skin_reflectance_table.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina {

/// A leaf in place of skin.
struct LeafCapture {
  std::optional<double> ground;  ///< reflectance behind it; absent: that of the background
  bool shares_misfit = false, has_background = true;  ///< as LeafPixelOptions have them
};

/// Photographs of skin, registered and calibrated: what each place reflects in some bands.
struct Capture {
  std::string name;
  Image reflectance;  ///< [y][x][band] fractions of what white reflects; channels are bands
  /// Standard deviation of each, by noise; empty: nowhere more than `errors` say
  Image deviation;
  PixelMask mask;              ///< pixels that are used
  std::vector<double> errors;  ///< [band] relative standard deviation, noise and calibration
  /// Covariance of the logarithms of gains that are not known, [band][band]: the same error at all
  /// pixels. Empty: none
  DenseMatrix gain_covariance;
  std::vector<Image> lights;             ///< patterns of light [y][x], "Y"; empty: even light
  std::vector<std::size_t> band_lights;  ///< [band] which of them; empty: the first
  std::vector<double> wavelengths;       ///< [nm] of the spectra that bands see
  DenseMatrix sensor;         ///< [band][wavelength] weights of a spectrum, rows of sum 1
  Incidence incidence;        ///< of the light
  bool has_specular = false;  ///< whether what the surface mirrors is part of it
  std::optional<double> mm_per_pixel;
  std::optional<LeafCapture> leaf;           ///< in place of all that follows
  SkinRecipe skin;                           ///< what is not acquired
  std::vector<SkinFitNumber> numbers;        ///< what is
  bool has_stated_numbers = false;           ///< whether the file says which
  std::optional<SkinPopulation> population;  ///< what is known before; absent: nothing
  std::string population_name;               ///< as the file has it
  std::vector<std::string> notes;            ///< what was done to the photographs, in sentences
  /// Reflectance of skin at its wavelengths in its light, where that was asked for: table_of
  std::shared_ptr<const SkinReflectanceTable> table = nullptr;
};

/// The table of a capture; it is made if the capture has none yet, for whoever asks to hand it
/// down.
/// @throws as SkinReflectanceTable
[[nodiscard]] std::shared_ptr<const SkinReflectanceTable> table_of(const Capture& capture,
                                                                   const Progress& progress = {});

}  // namespace lamina
