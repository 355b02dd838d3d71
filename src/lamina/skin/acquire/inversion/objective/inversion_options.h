// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/solve/scattering/heterogeneous/blurs/gaussian_blurs.h"

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

}  // namespace lamina
