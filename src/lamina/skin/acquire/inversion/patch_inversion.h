// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/progress.h"
#include "lamina/skin/acquire/inversion/objective/inversion_options.h"
#include "lamina/skin/acquire/inversion/texels/inversion_tables.h"
#include "lamina/skin/acquire/inversion/texels/patch_capture.h"
#include "lamina/skin/fit/least_squares/band_misfit.h"

namespace lamina {

/// A number of skin over the patch.
struct NumberMap {
  std::string name;  ///< as in skin_fit_numbers
  Plane value;
  Plane deviation;    ///< standard deviation of the coordinate of skin_fit_numbers; empty: none
  Plane prior_share;  ///< that over the prior's, at most 1; without a population over
                      ///< `wide_deviation`
};

struct InversionResult {
  std::vector<NumberMap> numbers;
  DenseMatrix correlation;         ///< of the coordinates, mean over texels; empty: not computed
  std::vector<Plane> residual;     ///< [image] measured less predicted; 0 where not known
  std::vector<double> smoothness;  ///< first and third weights that were used, [2 * number]
  std::vector<InversionStep> history;
  /// Misfit to each image, beside what stated errors leave; empty: no standard deviations were
  /// asked for, it was interrupted, or texels are by themselves and growth was given
  std::vector<BandMisfit> misfit;
  std::vector<double> error_growth;  ///< [image] factors of stated errors that were used
  double deviation_forwards = 0.0;   ///< that standard deviations took
  InversionStop stop = InversionStop::converged;
};

/// Inverts photographs of a patch to the numbers of skin at each texel, with light that travels
/// sideways in the skin: the maps whose light by DifferentiableTransport meets the photographs,
/// smooth as far as these allow, by least squares
///
///     1/2 sum of residual² / deviation²
///     + 1/2 sum over numbers of smoothness * (derivatives of the map)²
///     + 1/2 sum over texels of the prior's squares
///
/// over coordinates of skin_fit_numbers. The prior is that of the population of the tables; without
/// one it is as wide as `wide_deviation` about the reference skin. Where smoothness ties all texels
/// to one skin each counts the prior's squares by one over their number, so that the patch as a
/// whole is drawn from the population; without smoothness each texel is.
///
/// Standard deviations hold what is left: where chi squared of an image is above 1 its errors grow
/// by the root of that (band_misfit.h), and the maps are those of the grown errors.
///
/// Gauss-Newton steps are solved by conjugate gradients with tangent and gradient of the transport;
/// the preconditioner is each texel's block of the matrix for waves of each octave. Where
/// smoothness is chosen, steps of L-BFGS, which take it, too, come before.
///
/// @param tables  made for this capture, or one with the same wavelengths and angle
/// @param progress  told the share of most_forwards and what the samples take; asked to stop, the
/// best maps so far are handed
///                  over
/// @throws InvalidInput as check_capture, and for options out of range.
///
/// Sources: [Donner2008] §6 for the problem; [NocedalWright2006] §7.
[[nodiscard]] InversionResult invert_patch(const PatchCapture& capture,
                                           const InversionTables& tables,
                                           const InversionOptions& options = {},
                                           const Progress& progress = {});

/// Misfit to each image of some texels, each by itself, where errors have grown to it:
/// by error_growth_of, the growth that invert_patch finds by texel where none is given.
///
/// @throws InvalidInput as invert_patch
[[nodiscard]] std::vector<BandMisfit> misfit_of_texels(const PatchCapture& capture,
                                                       const InversionTables& tables,
                                                       const InversionOptions& options);

}  // namespace lamina
