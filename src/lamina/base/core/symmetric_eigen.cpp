// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/symmetric_eigen.h"

#include <Eigen/Eigenvalues>
#include <cassert>

namespace lamina {

SymmetricEigen symmetric_eigen(const DenseMatrix& a) {
  assert(a.rows == a.columns);
  const auto n = static_cast<Eigen::Index>(a.rows);
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      Eigen::Map<const Rows>(a.values.data(), n, n));
  SymmetricEigen result{.values = {}, .vectors = DenseMatrix(a.rows, a.rows)};
  for (Eigen::Index j = 0; j < n; ++j) {
    result.values.push_back(solver.eigenvalues()[j]);
    for (Eigen::Index i = 0; i < n; ++i)
      result.vectors(static_cast<std::size_t>(i), static_cast<std::size_t>(j)) =
          solver.eigenvectors()(i, j);
  }
  return result;
}

}  // namespace lamina
