// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/least_squares/internal/fit_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "lamina/base/core/number_text.h"
#include "lamina/base/core/symmetric_eigen.h"

namespace lamina::fit_detail {
namespace {

/// Curvatures that are smaller than this part of the largest, with each parameter in its own scale,
/// are none: rounding and differences leave no less.
constexpr double no_curvature = 1e-10;
/// A component of a direction without curvature that is less than this part of the largest is none.
constexpr double no_component = 1e-3;
/// A parameter is unknown where a direction that the data do not tell takes it through so much of
/// its range.
constexpr double much_of_range = 0.1;

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i)
    list += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return list;
}

/// What a direction that changes no prediction means.
std::string free_direction_note(const std::vector<FitParameter>& parameters,
                                const std::vector<double>& direction) {
  double largest = 0.0;
  for (const double component : direction)
    if (std::abs(component) > std::abs(largest)) largest = component;
  std::vector<std::string> names, up, down;
  bool is_scaling = true;
  for (std::size_t i = 0; i < direction.size(); ++i) {
    const double component = direction[i] / largest;
    if (std::abs(component) < no_component) continue;
    names.push_back(parameters[i].name);
    is_scaling = is_scaling && parameters[i].scale == FitScale::logarithmic &&
                 std::abs(std::abs(component) - 1.0) < no_component;
    (component > 0.0 ? up : down).push_back(parameters[i].name);
  }
  if (names.size() == 1) return names[0] + ": the data do not depend on it";
  if (!is_scaling)
    return listed(names) + ": the data tell a combination of them only, not each one";
  if (up.size() < down.size()) std::swap(up, down);
  return listed(up) + (down.empty() ? "" : " divided and " + listed(down) + " multiplied") +
         (down.empty() ? " multiplied by any one factor" : " by any one factor") +
         " give the same prediction: the data cannot tell the scale";
}

/// How far a parameter can go: in its coordinate, and along a straight line of its value.
struct Reach {
  double coordinate, straight;
};

Reach reach_of(const FitParameter& parameter, double coordinate) {
  const double range =
      fit_coordinate(parameter, parameter.high) - fit_coordinate(parameter, parameter.low);
  const double slope = std::abs(fit_value_derivative(parameter, coordinate));
  return {range, std::max(range, (parameter.high - parameter.low) / slope)};
}

/// A direction along which the data tell no better than the ranges of parameters.
struct OpenDirection {
  std::vector<double> components;  ///< [parameter]
  std::vector<bool> is_unknown;    ///< [parameter] goes through much of its range
  bool is_free;                    ///< changes no prediction
};

/// How the coordinates of all parameters spread, those at a bound as if it were not there.
struct Spread {
  DenseMatrix covariance;        ///< but for what is unknown
  std::vector<bool> is_unknown;  ///< [parameter]
  std::vector<OpenDirection> open_directions;
};

/// A direction of which the data tell less than the ranges do counts as spread evenly over what the
/// ranges leave of it: who does not know g may know absorption well, which hardly goes with it.
Spread spread_of(const std::vector<FitParameter>& parameters, std::span<const double> coordinates,
                 const DenseMatrix& jacobian, double variance) {
  const std::size_t n = jacobian.columns;
  DenseMatrix h = multiply(transpose(jacobian), jacobian);
  std::vector<double> scale(n);
  std::vector<Reach> reach;
  for (std::size_t a = 0; a < n; ++a) {
    scale[a] = h(a, a) > 0.0 ? std::sqrt(h(a, a)) : 1.0;
    reach.push_back(reach_of(parameters[a], coordinates[a]));
  }
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b) h(a, b) /= scale[a] * scale[b];

  Spread spread{
      .covariance = DenseMatrix(n, n), .is_unknown = std::vector<bool>(n), .open_directions = {}};
  const SymmetricEigen eigen = symmetric_eigen(h);
  for (std::size_t e = 0; e < n; ++e) {
    std::vector<double> direction(n);
    double largest = 0.0;
    for (std::size_t a = 0; a < n; ++a) {
      direction[a] = eigen.vectors(a, e) / scale[a];
      largest = std::max(largest, std::abs(direction[a]));
    }
    double length = std::numeric_limits<double>::infinity();  // between the ends of ranges
    for (std::size_t a = 0; a < n; ++a)
      if (std::abs(direction[a]) >= no_component * largest)
        length = std::min(length, reach[a].straight / std::abs(direction[a]));
    const bool is_free = !(eigen.values[e] > no_curvature * eigen.values.back());
    const double even = length * length / 12.0;  // variance of what is spread evenly
    double square = is_free ? even : variance / eigen.values[e];
    if (is_free || square > even) {
      square = std::isfinite(even) ? even : 0.0;
      OpenDirection open{direction, std::vector<bool>(n), is_free};
      for (std::size_t a = 0; a < n; ++a)
        if (std::abs(direction[a]) >= no_component * largest &&
            (!std::isfinite(length) ||
             std::abs(direction[a]) * length >= much_of_range * reach[a].coordinate))
          open.is_unknown[a] = spread.is_unknown[a] = true;
      spread.open_directions.push_back(std::move(open));
    }
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b)
        spread.covariance(a, b) += square * direction[a] * direction[b];
  }
  return spread;
}

/// Says what an open direction means, if not for parameters at bounds alone, of which it is said.
void add_note(const std::vector<FitParameter>& parameters, const OpenDirection& direction,
              const std::vector<bool>& is_held, FitResult& result) {
  std::vector<std::string> unknown;
  bool has_others = false;
  double largest = 0.0;
  for (const double component : direction.components)
    largest = std::max(largest, std::abs(component));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (direction.is_unknown[i] && !is_held[i]) unknown.push_back(parameters[i].name);
    has_others = has_others || (std::abs(direction.components[i]) >= no_component * largest &&
                                !direction.is_unknown[i]);
  }
  if (unknown.empty()) return;
  result.notes.push_back(direction.is_free && !has_others
                             ? free_direction_note(parameters, direction.components)
                             : listed(unknown) + ": the data tell no better than the range");
}

void add_notes(const std::vector<FitParameter>& parameters, FitResult& result) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const FittedParameter& fitted = result.parameters[i];
    if (fitted.is_at_bound)
      result.notes.push_back(parameters[i].name + ": unknown, since it ended at its range, " +
                             printf_text("%.6g", fitted.value) +
                             "; errors of other numbers are as if it were free to go on");
    else if (fitted.prior_share > prior_share_of_note)
      result.notes.push_back(parameters[i].name + ": from the prior, the data add little");
  }
  for (std::size_t i = 0; i < parameters.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (std::abs(result.correlation(i, j)) > correlation_of_note)
        result.notes.push_back(parameters[j].name + " and " + parameters[i].name +
                               ": hardly told apart, correlation " +
                               printf_text("%.3f", result.correlation(i, j)));
}

}  // namespace

void add_errors(const std::vector<FitParameter>& parameters, std::span<const double> coordinates,
                const DenseMatrix& jacobian, const std::vector<bool>& is_held, double variance,
                FitResult& result) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Spread spread = spread_of(parameters, coordinates, jacobian, variance);
  for (const OpenDirection& direction : spread.open_directions)
    add_note(parameters, direction, is_held, result);

  const DenseMatrix& covariance = spread.covariance;
  result.correlation = DenseMatrix(parameters.size(), parameters.size());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const FitParameter& parameter = parameters[i];
    FittedParameter& fitted = result.parameters.emplace_back();
    fitted.value = fit_value(parameter, coordinates[i]);
    fitted.is_at_bound = is_held[i];
    result.correlation(i, i) = 1.0;
    if (is_held[i]) {
      fitted.standard_deviation = fitted.low_error = fitted.high_error = infinity;
      continue;
    }
    const double sd = spread.is_unknown[i] ? infinity : std::sqrt(covariance(i, i));
    fitted.standard_deviation = sd;
    fitted.low_error = fitted.value - fit_value(parameter, coordinates[i] - sd);
    fitted.high_error = fit_value(parameter, coordinates[i] + sd) - fitted.value;
    if (parameter.prior) fitted.prior_share = sd / parameter.prior->standard_deviation;
    for (std::size_t j = 0; j < i; ++j)
      if (!is_held[j] && !spread.is_unknown[i] && !spread.is_unknown[j])
        result.correlation(i, j) = result.correlation(j, i) =
            covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j));
  }
  add_notes(parameters, result);
}

}  // namespace lamina::fit_detail
