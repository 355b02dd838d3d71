// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/fit/least_squares/internal/fit_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "lamina/core/number_text.h"
#include "lamina/core/symmetric_eigen.h"

namespace lamina::fit_detail {
namespace {

/// Curvatures that are smaller than this part of the largest, with each parameter in its own scale,
/// are none: rounding and differences leave no less.
constexpr double no_curvature = 1e-10;
/// A component of a direction without curvature that is less than this part of the largest is none.
constexpr double no_component = 1e-3;

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

/// Columns of the parameters that are not held.
DenseMatrix curvature_of(const DenseMatrix& jacobian, const std::vector<std::size_t>& free) {
  DenseMatrix h(free.size(), free.size());
  for (std::size_t row = 0; row < jacobian.rows; ++row)
    for (std::size_t a = 0; a < free.size(); ++a)
      for (std::size_t b = 0; b < free.size(); ++b)
        h(a, b) += jacobian(row, free[a]) * jacobian(row, free[b]);
  return h;
}

void add_notes(const std::vector<FitParameter>& parameters, FitResult& result) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const FittedParameter& fitted = result.parameters[i];
    if (fitted.is_at_bound)
      result.notes.push_back(parameters[i].name + ": held at its bound, " +
                             number_text(fitted.value));
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
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (!is_held[i]) free.push_back(i);
  DenseMatrix h = curvature_of(jacobian, free);
  std::vector<double> scale(free.size());
  for (std::size_t a = 0; a < free.size(); ++a) scale[a] = h(a, a) > 0.0 ? std::sqrt(h(a, a)) : 1.0;
  for (std::size_t a = 0; a < free.size(); ++a)
    for (std::size_t b = 0; b < free.size(); ++b) h(a, b) /= scale[a] * scale[b];

  DenseMatrix covariance(free.size(), free.size());
  std::vector<bool> is_unknown(free.size(), false);
  const SymmetricEigen eigen = free.empty() ? SymmetricEigen() : symmetric_eigen(h);
  for (std::size_t e = 0; e < eigen.values.size(); ++e) {
    if (eigen.values[e] > no_curvature * eigen.values.back()) {
      for (std::size_t a = 0; a < free.size(); ++a)
        for (std::size_t b = 0; b < free.size(); ++b)
          covariance(a, b) += variance * eigen.vectors(a, e) * eigen.vectors(b, e) /
                              (eigen.values[e] * scale[a] * scale[b]);
      continue;
    }
    std::vector<double> direction(parameters.size(), 0.0);
    double largest = 0.0;
    for (std::size_t a = 0; a < free.size(); ++a) {
      direction[free[a]] = eigen.vectors(a, e) / scale[a];
      largest = std::max(largest, std::abs(direction[free[a]]));
    }
    for (std::size_t a = 0; a < free.size(); ++a)
      if (std::abs(direction[free[a]]) >= no_component * largest) is_unknown[a] = true;
    result.notes.push_back(free_direction_note(parameters, direction));
  }

  result.correlation = DenseMatrix(parameters.size(), parameters.size());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    FittedParameter& fitted = result.parameters.emplace_back();
    fitted.value = fit_value(parameters[i], coordinates[i]);
    fitted.is_at_bound = is_held[i];
    result.correlation(i, i) = 1.0;
  }
  for (std::size_t a = 0; a < free.size(); ++a) {
    const FitParameter& parameter = parameters[free[a]];
    FittedParameter& fitted = result.parameters[free[a]];
    const double sd =
        is_unknown[a] ? std::numeric_limits<double>::infinity() : std::sqrt(covariance(a, a));
    fitted.standard_deviation = sd;
    fitted.low_error = fitted.value - fit_value(parameter, coordinates[free[a]] - sd);
    fitted.high_error = fit_value(parameter, coordinates[free[a]] + sd) - fitted.value;
    if (parameter.prior) fitted.prior_share = sd / parameter.prior->standard_deviation;
    for (std::size_t b = 0; b < a; ++b)
      if (!is_unknown[a] && !is_unknown[b])
        result.correlation(free[a], free[b]) = result.correlation(free[b], free[a]) =
            covariance(a, b) / std::sqrt(covariance(a, a) * covariance(b, b));
  }
  add_notes(parameters, result);
}

}  // namespace lamina::fit_detail
