// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/progress.h"
#include "lamina/base/image/image.h"
#include "lamina/layers/materials/leaf.h"
#include "lamina/skin/acquire/calibration/pixel_mask.h"
#include "lamina/skin/fit/least_squares/band_misfit.h"
#include "lamina/skin/fit/least_squares/fit_parameter.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina {

/// A number of the leaf that each pixel is free to choose.
struct LeafNumber {
  FitParameter parameter;  ///< called as in files; with a prior
  double LeafParameters::*value = nullptr;
};

/// Chlorophyll, carotenoids, anthocyanins, brown pigments, water, dry matter and structure, as wide
/// as they are in leaves of many plants: the usual ranges of docs/materials.md lie within about
/// one standard deviation. Source: the data of [Feret2017].
[[nodiscard]] std::vector<LeafNumber> leaf_numbers();

/// Parameter of the light on a pixel of a leaf: the light on it over that on the white reference,
/// which lay flat, by its tilt and by shadows.
[[nodiscard]] FitParameter leaf_illumination();

/// And what its surface mirrors to the camera, the same at all wavelengths, as a reflectance.
/// Source: [Jay2016].
[[nodiscard]] FitParameter leaf_gloss();

struct LeafPixelOptions {
  LeafParameters leaf = {};  ///< what numbers are that are not free
  std::vector<LeafNumber> numbers = leaf_numbers();
  FitParameter illumination = leaf_illumination(), gloss = leaf_gloss();
  Incidence incidence = {};  ///< of the light
  /// Reflectance of what lies behind the leaf, [band]. Empty: that of the background pixels, the
  /// median; black if there are none.
  std::vector<double> ground = {};
  /// Standard deviation of each band's noise and of the model's misfit, as a reflectance, [band].
  /// Empty: from the residuals, which are taken to go together from band to band as they do.
  std::vector<double> noise = {};
  /// Whether what all pixels miss alike is taken off, so that the errors are those of the pixels'
  /// scatter alone: numbers then say how places of one leaf differ. Their common level is no better
  /// known than without, and deviations do not hold its error. For noise that is found.
  bool shares_misfit = false;
  std::optional<PixelMask> mask = {};  ///< absent: all pixels are used
  /// Whether pixels without pigment are told apart, by bands in which pigments absorb. If not, all
  /// that the mask uses is leaf.
  bool has_background = true;
  int edge = 1;  ///< so many pixels about the background are left out, >= 0
};

/// Kind of a pixel.
enum class LeafPixelKind : std::uint8_t {
  leaf,
  unused,      ///< by the mask, or not finite in some band
  background,  ///< has no pigment: its spectrum is straight and hardly rises, or dark
  edge,        ///< too near to background, and partly of it
};
inline constexpr std::size_t leaf_pixel_kinds = 4;

/// A number at every pixel.
struct LeafMap {
  FitParameter parameter;
  Image values;      ///< one channel "Y"; NaN where there is no leaf
  Image deviations;  ///< of the coordinate, "Y"; NaN where there is no leaf
  /// Median over the leaf of the deviation over the prior's: beyond prior_share_of_note the bands
  /// do not tell the number.
  double prior_share = 1.0;
};

/// Maps of what leaves are made of.
struct LeafMaps {
  int width = 0, height = 0;
  std::vector<LeafMap> maps;     ///< the numbers, then "illumination" and "gloss"
  Image predicted;               ///< what they reflect, channels of the image; NaN without leaf
  Image misfit;                  ///< "Y": RMS over bands of the residual; NaN without leaf
  std::vector<double> residual;  ///< [band] RMS over the leaf
  std::vector<double> bias;      ///< [band] mean over the leaf of measured less predicted
  DenseMatrix correlation;       ///< of coordinates, as `maps`; mean over the leaf
  std::vector<double> ground;    ///< [band] that was used
  std::vector<double> missed;    ///< [band] what pixels share of the misfit, a part of `predicted`
  std::vector<double> noise;     ///< [band] that was used, grown
  /// [band] reduced chi squared of what the maps leave, by the noise that was found or given
  std::vector<double> chi_squared;
  std::vector<double> error_growth;   ///< [band] factors of that noise that were used
  double residual_correlation = 0.0;  ///< of residuals of neighboring bands that was used
  std::vector<LeafPixelKind> kinds;   ///< [y][x]
  std::array<std::size_t, leaf_pixel_kinds> counts = {};  ///< of each kind
};

/// The most likely leaf at each pixel, on its own: no light goes from one pixel to another, and no
/// pixel knows of its neighbors.
///
/// A pixel reflects illumination · (R + T² ground / (1 - R ground)) + gloss, with the totals R and
/// T of the recipe under the light's incidence, R without what the surface mirrors. A leaf is taken
/// to look alike from everywhere but for its gloss, and to do to light from below what it does to
/// light from above. Source: [Jay2016] for the two numbers of the light.
///
/// Standard deviations are those of the Gaussian about the solution. If the noise is found from the
/// residuals, errors of neighboring bands go together by the residuals' correlation c: variances
/// grow by (1 + c) / (1 - c), as those of a mean over many bands do.
///
/// Where residuals of a band are larger than its noise says, that grows by the root of chi squared
/// (band_misfit.h).
///
/// @param image        reflectance factors: 1 is the white reference. Channel b is band b
/// @param wavelengths  [nm], [band], those of the recipe
/// @throws InvalidInput naming what does not fit: sizes, a number without prior, fewer bands than
///         free numbers, no leaf in the image; Interrupted if progress asks to stop.
[[nodiscard]] LeafMaps fit_leaf_pixels(const Image& image, const std::vector<double>& wavelengths,
                                       const LeafPixelOptions& options = {},
                                       const Progress& progress = {});

}  // namespace lamina
