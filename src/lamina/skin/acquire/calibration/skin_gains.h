// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/image/image.h"
#include "lamina/skin/acquire/calibration/pixel_mask.h"
#include "lamina/skin/fit/skin/skin_population.h"
#include "lamina/solve/reflectance/skin_reflectance_table.h"

namespace lamina {

/// The colors that people's skin has: a Gaussian of the logarithms of some channels.
struct SkinColors {
  std::vector<double> mean;  ///< [channel]
  DenseMatrix covariance;    ///< [channel][channel]
};

/// Colors of a population as a sensor sees them: of skins drawn at random, with what the model
/// misses of measured skin.
/// @param sensor  weights of the spectrum in a channel, [channel][wavelength of the table]; those
/// of
///                make_skin_band_weights for linear sRGB
/// @param count   of skins, >= 100
/// @param with_specular  whether what the surface mirrors is part of the color
/// @throws InvalidInput
[[nodiscard]] SkinColors make_skin_colors(const SkinReflectanceTable& table,
                                          const DenseMatrix& sensor,
                                          const SkinPopulation& population, bool with_specular,
                                          int count, std::uint64_t seed);

/// The median color of the skin in an image, as logarithms, [channel]: what one person tells.
/// @param skin  its pixels; not lips, hair, or clothes. Those with a channel not above 0 do not
/// count.
/// @throws InvalidInput if fewer than 16 pixels count.
[[nodiscard]] std::vector<double> median_log_color(const Image& image, const PixelMask& skin);

/// Prior of gains, as standard deviations of their logarithms.
struct SkinGainPrior {
  double level = 0.7;  ///< of what all channels have in common: exposure
  double color = 0.3;  ///< of each channel's own: white balance
  /// How much more people differ than the Gaussian of their population says, >= 1: that of the
  /// forearms holds the middle of 100 people (16 to 84 %), whose dark tail makes their standard
  /// deviation 1.2 to 1.6 times as large.
  double widening = 1.5;
};

struct SkinGains {
  std::vector<double> gains;  ///< [channel] to multiply a channel with
  DenseMatrix covariance;     ///< of their logarithms
  /// Standard deviation of each logarithm over that of the prior; near 1 the skin tells nothing.
  std::vector<double> prior_share;
  /// How far corrected colors are from the population's middle and gains from their prior's, in
  /// standard deviations: the root of the mean square over people and channels. Far above 1 this is
  /// other skin, none, or a camera whose gains are not these.
  double distance = 0.0;
};

/// The gains that make the colors of some people's skin most probable for their population: where
/// there is neither a chart nor a white reference.
///
/// One person's skin may be light or dark: however many pixels it has, it is one draw from the
/// population, so the gains' errors are those of people's colors, which go together over channels
/// and grow smaller with people, not pixels. These errors are to be carried on; they are as large
/// as a tenth in blue, of which most is brightness.
///
/// @param people  median_log_color of each, all with the same camera, light and exposure
/// @throws InvalidInput for no people, a number of channels other than the population's, or a prior
///         out of range.
[[nodiscard]] SkinGains fit_skin_gains(std::span<const std::vector<double>> people,
                                       const SkinColors& population,
                                       const SkinGainPrior& prior = {});

/// How pixels differ from the skin that gains make of others.
struct SkinPixels {
  PixelMask mask;  ///< those of skin's color are used, others `excluded`
  /// Counts of the used pixels: of skin's color, too dark, too bright, of another color
  std::size_t skin = 0, dark = 0, bright = 0, colored = 0;
};

/// The pixels whose corrected color lies in the ellipsoid that holds 99 % of people's; others are
/// too dark or too bright where all channels are by more than a standard deviation.
/// @param gains  [channel]
[[nodiscard]] SkinPixels pixels_of_skin(const Image& image, const PixelMask& mask,
                                        std::span<const double> gains,
                                        const SkinColors& population);

/// Gains, and the pixels of skin that they were found from.
struct FoundSkinGains {
  SkinGains gains;
  SkinPixels pixels;
};

/// The gains of one image in which not all that is used is skin: from the pixels that may be skin
/// by some gains of the prior, or from all if these are few, then from those of skin's color by the
/// gains, until they stay the same.
/// @throws InvalidInput as median_log_color and fit_skin_gains
[[nodiscard]] FoundSkinGains find_skin_gains(const Image& image, const PixelMask& mask,
                                             const SkinColors& population,
                                             const SkinGainPrior& prior = {});

}  // namespace lamina
