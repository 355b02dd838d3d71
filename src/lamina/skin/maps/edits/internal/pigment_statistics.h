// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/base/core/dense_matrix.h"

namespace lamina::skin_edits {

/// Mean and covariance of some coordinates over an area.
struct CoordinateStatistics {
  std::vector<double> mean;  ///< [coordinate]
  DenseMatrix covariance;    ///< [coordinate][coordinate]
};

/// @param coordinates  [coordinate][texel], texels of one grid; a single one is the same everywhere
/// @param weights      [texel] >= 0, not all 0; empty: all alike
[[nodiscard]] CoordinateStatistics statistics_of(const std::vector<std::vector<float>>& coordinates,
                                                 std::span<const float> weights);

/// The linear map that turns deviations from one mean into those from another, such that the
/// covariance becomes the other one, and moves each as little as can be: of two normal
/// distributions the optimal transport. Where there is no variance, none is made.
/// Source: [OlkinPukelsheim1982]
[[nodiscard]] DenseMatrix transport_between(const DenseMatrix& from, const DenseMatrix& to);

}  // namespace lamina::skin_edits
