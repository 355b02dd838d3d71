// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/progress.h"
#include "lamina/skin/acquire/inversion/inversion_tables.h"
#include "lamina/skin/acquire/inversion/patch_capture.h"
#include "lamina/skin/fit/least_squares/band_misfit.h"

namespace lamina {

struct InversionOptions {
  /// Each texel by itself, as if its surroundings were like it
  bool is_by_texel = false;
  /// How much numbers of neighbors are taken to be alike, [number]: the weight of the squared
  /// difference of the coordinates of two texels side by side, half of it counting beside half of
  /// the squared residuals in standard deviations. With as many again, the weights of squares of
  /// third derivatives (differences of the sums of a texel's differences to its neighbors), both
  /// count by less at edges, where maps change as they like. First weights do not depend on the
  /// size of a texel, third ones go with the inverse of its fourth power. Empty: chosen by the data
  std::vector<double> smoothness;
  /// Residuals beyond so many standard deviations count as straight lines, not as squares (Huber);
  /// 0: all as squares
  double robust_limit = 0.0;
  double model_error =
      0.0;  ///< of the forward model, relative to what is measured: joins the noise
  /// Relative error of the level of an image, shared by all its texels, which joins standard
  /// deviations: of the transport, .0001 to .0026 with three bounces between layers, and of white
  double level_error = 0.001;
  /// Factors of the stated errors of the images, [image]; empty: those that residuals ask for where
  /// standard deviations are computed, by which maps are solved anew; else 1
  std::vector<double> error_growth = {};
  /// Forward equivalents: light, change and gradient are one each. Where errors grow as many again
  double most_forwards = 120.0;
  double tolerance = 1e-3;     ///< relative decrease of the objective that ends the steps
  bool stops_at_noise = true;  ///< ends where residuals are at their standard deviations, too
  /// Drawn for standard deviations; 0: none are computed. `is_by_texel` has them without draws
  int deviation_samples = 0;
  std::uint64_t seed = 0;  ///< of these
  /// [number] values; with the smoothness that they were found with they go on. Empty: from
  /// coarser grids
  std::vector<Plane> start;
};

/// A number of skin over the patch.
struct NumberMap {
  std::string name;  ///< as in skin_fit_numbers
  Plane value;
  Plane deviation;    ///< standard deviation of the coordinate of skin_fit_numbers; empty: none
  Plane prior_share;  ///< that over the prior's, at most 1; without a population over
                      ///< `wide_deviation`
};

/// Where an inversion stood.
struct InversionStep {
  double forwards = 0.0;       ///< forward equivalents so far
  double residual = 0.0;       ///< root of the mean square over images, each relative to its mean
  double in_deviations = 0.0;  ///< the same of residuals in standard deviations, as grown by then
  double objective = 0.0;      ///< with what smoothness and prior add
};

enum class InversionStop { converged, at_noise, most_forwards, interrupted };

template <>
inline constexpr auto enum_names<InversionStop> = std::to_array<EnumName<InversionStop>>(
    {{"converged", InversionStop::converged},
     {"at the noise", InversionStop::at_noise},
     {"at the limit of forward models", InversionStop::most_forwards},
     {"interrupted", InversionStop::interrupted}});

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
