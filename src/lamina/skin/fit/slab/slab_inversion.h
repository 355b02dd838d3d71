// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/skin/fit/least_squares/nonlinear_fit.h"
#include "lamina/skin/fit/slab/slab_measurement.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina {

struct SlabInversionOptions {
  Incidence incidence = {};
  double accuracy = 1e-4;  ///< asked of what is found, relative (g: absolute), in [1e-6, 0.1]
  int max_nodes = 96;      ///< of the direction grid's first segment; where refining stops
};

/// Inverted sample. Values that were not measured are as they were given, and have no error.
struct SlabInversion {
  FittedParameter sigma_a;        ///< [1/mm]
  FittedParameter sigma_s_prime;  ///< [1/mm] fitted if the transmittance is known
  FittedParameter g;              ///< fitted if the unscattered transmittance is known, too
  bool has_sigma_s_prime = false, has_g = false;  ///< whether those two were fitted
  FitResult fit;  ///< of those fitted, in this order; its predictions are on the last grid
  int nodes = 0;  ///< of that grid
  double estimated_error = 0.0;  ///< of what was found, by the grid; relative (g: absolute)
  bool is_accurate = false;      ///< that is within options.accuracy, or a tenth of the errors
};

/// The coefficients of one layer from totals of the stack that it is part of, as of a sample
/// between slides of glass: inverse adding-doubling.
///
/// Starts from a closed form and goes on by Levenberg and Marquardt's steps with exact derivatives
/// on one coarse grid of directions. What finer grids change of the prediction is then taken as
/// constant, and the fit repeated, until the coefficients stay.
///
/// The unscattered transmittance tells the extinction, and with it g. It counts if it is at least
/// three times its standard deviation; else g stays as given, and a note says so.
///
/// @param stack   with the sample's thickness, indices, and the g (and sigma_s) to be kept where
///                they cannot be found; smooth boundaries. The sample scatters by
///                Henyey-Greenstein's phase function.
/// @param sample  the layer, of finite thickness if the transmittance is given.
/// @throws InvalidInput naming the total, the rule that it breaks and its value: totals outside
///         [0, 1.2], reflectance and transmittance that exceed 1 by more than five standard
///         deviations, more unscattered than transmitted; and as adding_doubling_derivatives.
///
/// Source: [Prahl1993]; the fixed grid and its correction are lamina's.
[[nodiscard]] SlabInversion invert_slab(const LayerStack& stack, std::size_t sample,
                                        const SlabMeasurement& measurement,
                                        const SlabInversionOptions& options = {});

}  // namespace lamina
