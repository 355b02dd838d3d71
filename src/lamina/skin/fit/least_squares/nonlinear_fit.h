// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/skin/fit/least_squares/fit_parameter.h"

namespace lamina {

/// Measured data.
struct FitData {
  std::vector<double> measured;
  std::vector<double> standard_deviation = {};  ///< of each, > 0; or:
  DenseMatrix covariance = {};                  ///< of all, where errors go together
  /// Whether the errors above are known as they are. If not, only their ratios are, and what is
  /// left of the measurement says how large they are.
  bool has_known_errors = true;
};

/// Model that is to meet the data.
struct FitModel {
  /// Prediction of parameters of these values, as many numbers as were measured. A number that is
  /// not finite means that there is no prediction; the fit then takes a shorter step.
  std::function<std::vector<double>(std::span<const double> values)> predict;
  /// Derivatives by the values, [prediction][parameter]; empty: by central differences.
  std::function<DenseMatrix(std::span<const double> values)> derivatives = {};
};

struct FitOptions {
  int max_iterations = 200;
  double tolerance = 1e-10;  ///< the longest step that counts as none, of coordinates beyond 1
                             ///< relative
  /// Residuals beyond so many standard deviations count as straight lines, not as squares (Huber);
  /// 0: all as squares.
  double robust_limit = 0.0;
  /// How the priors of the parameters go together, [parameter][parameter] of their coordinates,
  /// with 1 on the diagonal; all then have a prior. Empty: they do not.
  DenseMatrix prior_correlation = {};
  int starts = 1;  ///< the first at the starts of the parameters, others drawn about them
  std::uint64_t seed = 0;
  double step = 1e-4;  ///< of central differences, in coordinates (linear: also times the value)
};

/// Result of a fit for one parameter.
struct FittedParameter {
  double value = 0.0;
  double low_error = 0.0, high_error = 0.0;  ///< from the value to one standard deviation
  double standard_deviation = 0.0;  ///< of the coordinate; infinite where the data do not tell
  double prior_share = 0.0;         ///< that over the prior's; 0 without a prior
  bool is_at_bound = false;         ///< it is held there, and its errors are infinite: unknown
};

struct FitResult {
  std::vector<FittedParameter> parameters;
  DenseMatrix correlation;  ///< of the coordinates; 0 beside those at a bound
  std::vector<double> prediction;
  std::vector<double> residual;           ///< measured - prediction, in standard deviations
  double chi_squared = 0.0;               ///< sum of their squares, without priors
  double prior_squares = 0.0;             ///< what the priors add to it
  std::ptrdiff_t degrees_of_freedom = 0;  ///< measured numbers less free parameters
  bool has_converged = false;
  int iterations = 0;
  int agreeing_starts = 1;         ///< of all starts, those that ended in the same place
  std::vector<std::string> notes;  ///< sentences on what the data cannot tell
};

/// Shares of the prior's standard deviation and correlations beyond these are in the notes.
inline constexpr double prior_share_of_note = 0.8, correlation_of_note = 0.95;

/// The parameters of least chi_squared + prior_squares in their ranges, by Levenberg and
/// Marquardt's steps in the coordinates; those at a bound that would cross it are held there.
///
/// Errors are those of the Gaussian about the solution: the inverse of half the second derivatives,
/// with these taken from the first ones alone. Combinations of parameters that the prediction does
/// not depend on are found, and named in the notes; their standard deviations are infinite. So are
/// those of parameters at a bound. Errors of others are with these free, as if the bound were not
/// there: held, they would be those of a measurement that knew them.
///
/// @throws InvalidInput naming what cannot be used: no parameters, errors that are not positive or
///         not as many as the data, a prior_correlation that is none, no prediction at the start;
///         errors unknown and no more data than parameters without prior.
///
/// Source: [Marquardt1963]; the scaling of the damping is that of [More1978]; [Huber1964].
[[nodiscard]] FitResult fit_parameters(const std::vector<FitParameter>& parameters,
                                       const FitData& data, const FitModel& model,
                                       const FitOptions& options = {});

}  // namespace lamina
