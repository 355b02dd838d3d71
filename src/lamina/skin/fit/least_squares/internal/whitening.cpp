// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/least_squares/internal/whitening.h"

#include <cmath>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina::fit_detail {
namespace {

void require_size(const std::string& what, std::size_t given, std::size_t wanted) {
  if (given != wanted)
    throw InvalidInput("data: " + what + " must hold " + std::to_string(wanted) +
                       " numbers, one for each that was measured, but holds " +
                       std::to_string(given));
}

/// L of a = L transpose(L).
DenseMatrix cholesky_factor(const DenseMatrix& a) {
  DenseMatrix factor(a.rows, a.rows);
  for (std::size_t i = 0; i < a.rows; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      if (!(std::abs(a(i, j) - a(j, i)) <= 1e-12 * std::sqrt(a(i, i) * a(j, j))))
        throw InvalidInput("data: the covariance must be symmetric, but is not in row " +
                           std::to_string(i));
      double sum = a(i, j);
      for (std::size_t k = 0; k < j; ++k) sum -= factor(i, k) * factor(j, k);
      if (i == j && !(sum > 0.0 && std::isfinite(sum)))
        throw InvalidInput("data: the covariance must be positive definite, but is not in row " +
                           std::to_string(i));
      factor(i, j) = i == j ? std::sqrt(sum) : sum / factor(j, j);
    }
  return factor;
}

}  // namespace

Whitening::Whitening(const FitData& data) : measured_(data.measured) {
  if (measured_.empty()) throw InvalidInput("data: at least one number must be measured");
  for (const double value : measured_)
    if (!std::isfinite(value)) throw InvalidInput("data: measured numbers must be finite");
  if (data.covariance.rows > 0) {
    require_size("a row of the covariance", data.covariance.rows, measured_.size());
    require_size("a column of the covariance", data.covariance.columns, measured_.size());
    if (!data.standard_deviation.empty())
      throw InvalidInput(
          "data: has standard deviations and a covariance, but needs one of the two");
    factor_ = cholesky_factor(data.covariance);
    return;
  }
  require_size("standard_deviation", data.standard_deviation.size(), measured_.size());
  for (const double sd : data.standard_deviation)
    if (!(std::isfinite(sd) && sd > 0.0))
      throw InvalidInput("data: standard deviations must be > 0, but one is " + number_text(sd));
  standard_deviation_ = data.standard_deviation;
}

void Whitening::apply(std::vector<double>& values) const {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (factor_.rows == 0) {
      values[i] /= standard_deviation_[i];
      continue;
    }
    for (std::size_t k = 0; k < i; ++k) values[i] -= factor_(i, k) * values[k];
    values[i] /= factor_(i, i);
  }
}

std::vector<double> Whitening::residual(std::span<const double> prediction) const {
  std::vector<double> left;
  for (std::size_t i = 0; i < measured_.size(); ++i) left.push_back(measured_[i] - prediction[i]);
  apply(left);
  return left;
}

void Whitening::apply(DenseMatrix& columns) const {
  std::vector<double> column(columns.rows);
  for (std::size_t j = 0; j < columns.columns; ++j) {
    for (std::size_t i = 0; i < columns.rows; ++i) column[i] = columns(i, j);
    apply(column);
    for (std::size_t i = 0; i < columns.rows; ++i) columns(i, j) = column[i];
  }
}

}  // namespace lamina::fit_detail
