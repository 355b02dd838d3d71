// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/base/image/image.h"
#include "lamina/skin/acquire/capture.h"
#include "lamina/skin/acquire/inversion/patch_inversion.h"
#include "lamina/skin/lookup/skin_lookup.h"

namespace lamina {

/// Kind of a pixel of a capture.
enum class PixelKind : std::uint8_t {
  skin,
  unused,    ///< by the capture's mask, which says why
  not_skin,  ///< of a color that skin of the population does not have
};
inline constexpr std::size_t pixel_kinds = 3;

/// A number of skin at every pixel.
struct AcquiredNumber {
  SkinFitNumber number;
  double prior_deviation = 0.0;  ///< of its coordinate among people
  Image values;               ///< one channel "Y"; where there is no skin that of the nearest color
  Image deviations;           ///< of the coordinate, "Y"; where there is no skin the prior's
  double prior_share = 1.0;   ///< median over skin of the deviation over the prior's
  double within_share = 1.0;  ///< the same for differences within the image: without errors that
                              ///< all pixels have alike
};

/// How pixels were solved together.
struct InversionCourse {
  bool has_transport = false;
  std::vector<double> smoothness;  ///< [number] that was used
  std::vector<InversionStep> history;
  InversionStop stop = InversionStop::converged;
};

/// Maps of what skin is made of, from photographs.
struct AcquiredSkin {
  int width = 0, height = 0;
  std::vector<AcquiredNumber> numbers;
  /// Reflectance of the maps, as the capture's, at every picture_step-th pixel; NaN
  /// where, and empty if, not worked out
  Image predicted;
  std::optional<InversionCourse> inversion;  ///< absent: each pixel by a table
  /// [band] of the capture: reduced chi squared of what the maps leave, by the errors that were
  /// stated (band_misfit.h); empty: not worked out
  std::vector<double> chi_squared;
  std::vector<double> error_growth;                  ///< [band] factors of these that were used
  std::vector<PixelKind> kinds;                      ///< [y][x]
  std::array<std::size_t, pixel_kinds> counts = {};  ///< of each kind
  std::array<std::size_t, color_sides> sides = {};   ///< of pixels of no skin's color, by ColorSide
};

/// Every so-manieth pixel along both sides makes the picture of an image: at most 320 along them.
[[nodiscard]] int picture_step(int width, int height);

/// Each pixel of a capture of three bands on its own: no light goes from one to the other, as in
/// textures of albedo.
/// @throws InvalidInput if the capture has other than three bands, or no pixel is skin; Interrupted
///         if progress asks to stop.
[[nodiscard]] AcquiredSkin acquire_pixels(const Capture& capture, const SkinLookup& lookup,
                                          const Progress& progress = {});

/// The lookup for a capture of three bands. @throws as SkinLookup
/// @param growth  factors of the errors of the bands; empty: 1
[[nodiscard]] SkinLookup lookup_of(const Capture& capture, const SkinReflectanceTable& table,
                                   std::span<const double> growth = {},
                                   const Progress& progress = {});

/// misfit_of_colors of some pixels, evenly spread over those that are used.
/// @throws InvalidInput if there is no population
[[nodiscard]] std::vector<BandMisfit> misfit_of_pixels(const Capture& capture,
                                                       const SkinReflectanceTable& table);

/// The middle of what pixels that are skin have, [y][x]; 1 if there are none. Of many pixels, of a
/// million of them.
[[nodiscard]] double median_over_skin(std::span<const float> values,
                                      const std::vector<PixelKind>& kinds);

/// Numbers whose error is more than this part of what people differ by come from the prior: the
/// capture does not tell them.
inline constexpr double share_of_prior = prior_share_of_note;

}  // namespace lamina
