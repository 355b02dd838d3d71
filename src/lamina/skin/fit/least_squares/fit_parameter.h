// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>

namespace lamina {

/// The coordinate in which a parameter is fitted, has its prior and its standard deviation.
enum class FitScale {
  linear,       ///< the value itself
  logarithmic,  ///< ln (value + offset): for what is positive over decades, as concentrations
  logit,        ///< ln((value - low) / (high - value)): for fractions
};

/// Prior of a parameter: a Gaussian in the coordinate of the scale.
struct FitPrior {
  double mean = 0.0;                ///< of the value; the median on the other scales
  double standard_deviation = 0.0;  ///< of the coordinate, > 0: 0.3 is 30 % on a logarithmic scale
};

/// A number that a fit is free to choose in [low, high].
struct FitParameter {
  std::string name;
  double start = 0.0;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  FitScale scale = FitScale::linear;
  std::optional<FitPrior> prior = {};
  /// Offset of the logarithmic scale, >= 0: what is hardly more than none. Values far below count
  /// linearly, so that none is in reach.
  double offset = 0.0;
};

/// The coordinate of a value. On the logit scale values within 1e-6 of an end of the range count as
/// that far from it.
[[nodiscard]] double fit_coordinate(const FitParameter& parameter, double value);

/// The value at a coordinate.
[[nodiscard]] double fit_value(const FitParameter& parameter, double coordinate);

/// The derivative of the value by the coordinate.
[[nodiscard]] double fit_value_derivative(const FitParameter& parameter, double coordinate);

/// @throws InvalidInput naming the parameter, the rule that it breaks and the value given.
void check_fit_parameter(const FitParameter& parameter);

}  // namespace lamina
