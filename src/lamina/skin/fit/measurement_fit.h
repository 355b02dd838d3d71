// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/core/progress.h"
#include "lamina/skin/fit/least_squares/nonlinear_fit.h"
#include "lamina/skin/fit/measured/measurement.h"
#include "lamina/skin/fit/predicted/measurement_tables.h"

namespace lamina {

/// A free number as it was found.
struct FittedNumber {
  std::string name;                 ///< its path, and its band where that is its own
  std::size_t free = 0;             ///< which of the measurement's free numbers
  std::optional<std::size_t> band;  ///< of what is per band
  FittedParameter fitted;
};

/// Numbers that were fitted together, and how their errors go together.
struct FittedGroup {
  std::vector<std::size_t> numbers;  ///< places in MeasurementFit::numbers
  DenseMatrix correlation;           ///< of these
};

/// Result of a measurement for a material.
struct MeasurementFit {
  std::vector<FittedNumber> numbers;
  std::vector<FittedGroup> groups;
  std::vector<std::vector<double>> values;     ///< [free number][band], as material_with takes them
  std::vector<std::vector<double>> predicted;  ///< [series][point]
  std::vector<std::vector<double>> residual;   ///< [series][point], in standard deviations
  std::vector<bool> has_exact_derivatives;     ///< [series] else some are by differences
  double chi_squared = 0.0, prior_squares = 0.0;
  std::ptrdiff_t degrees_of_freedom = 0;
  bool has_converged = false;
  std::vector<std::string> notes;  ///< sentences on what the data cannot tell
};

struct MeasurementFitOptions {
  /// Prepared for the measurement, where many are fitted; null: it has its own.
  const MeasurementTables* tables = nullptr;
  std::uint64_t seed = 0;  ///< of further starts
  Progress progress = {};  ///< told that the work goes on, not how far it is
};

/// Finds the free numbers of a measurement. Bands that share none are fitted each on its own.
///
/// The fit follows quick solutions on fixed grids, of which derivatives are exact, or at least
/// smooth. What accurate solutions make of its end is a factor on each prediction, for radial
/// profiles with its derivatives; the fit goes on with these, until it stays within a few
/// hundredths of its errors. So results are as right as the accurate solutions.
///
/// @throws InvalidInput if a solver refuses the material; Interrupted if progress asks to stop.
[[nodiscard]] MeasurementFit fit_measurement(const Measurement& measurement,
                                             const MeasurementFitOptions& options = {});

}  // namespace lamina
