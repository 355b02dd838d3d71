// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/base/core/dense_matrix.h"

namespace lamina {

/// Eigenvalues of a symmetric matrix, ascending, with their vectors of length 1.
struct SymmetricEigen {
  std::vector<double> values;
  DenseMatrix vectors;  ///< [component][eigenvalue]
};
[[nodiscard]] SymmetricEigen symmetric_eigen(const DenseMatrix& a);

}  // namespace lamina
