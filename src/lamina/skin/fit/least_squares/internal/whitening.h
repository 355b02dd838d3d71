// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/skin/fit/least_squares/nonlinear_fit.h"

namespace lamina::fit_detail {

/// Turns numbers with errors into independent ones with a standard deviation of 1.
class Whitening {
 public:
  /// @throws InvalidInput as fit_parameters.
  explicit Whitening(const FitData& data);

  /// Residual of the measurement.
  [[nodiscard]] std::vector<double> residual(std::span<const double> prediction) const;

  /// Each column of a matrix whose rows are those of the data.
  void apply(DenseMatrix& columns) const;

 private:
  void apply(std::vector<double>& values) const;

  std::vector<double> measured_;
  std::vector<double> standard_deviation_;  ///< empty with a factor
  DenseMatrix factor_;                      ///< Cholesky's, below the diagonal
};

}  // namespace lamina::fit_detail
