// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/skin/fit/least_squares/nonlinear_fit.h"

namespace lamina::fit_detail {

/// Standard deviations, correlations and notes of a solution.
///
/// @param coordinates  of the solution, [parameter]
/// @param jacobian     of whitened predictions and priors by coordinates, [row][parameter]
/// @param is_held      at a bound, [parameter]
/// @param variance     what a residual of 1 stands for: 1 where errors are known
void add_errors(const std::vector<FitParameter>& parameters, std::span<const double> coordinates,
                const DenseMatrix& jacobian, const std::vector<bool>& is_held, double variance,
                FitResult& result);

}  // namespace lamina::fit_detail
