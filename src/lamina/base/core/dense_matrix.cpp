// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/dense_matrix.h"

#include <Eigen/Dense>
#include <cassert>

namespace lamina {
namespace {

template <class T>
using Columns = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

/// In the order that Eigen's solvers work in.
template <class T>
Columns<T> to_columns(const BasicDenseMatrix<T>& a) {
  Columns<T> copy(static_cast<Eigen::Index>(a.rows), static_cast<Eigen::Index>(a.columns));
  for (std::size_t i = 0; i < a.rows; ++i)
    for (std::size_t j = 0; j < a.columns; ++j)
      copy(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = a(i, j);
  return copy;
}

DenseMatrix from_columns(const Eigen::MatrixXd& a) {
  DenseMatrix copy(static_cast<std::size_t>(a.rows()), static_cast<std::size_t>(a.cols()));
  for (std::size_t i = 0; i < copy.rows; ++i)
    for (std::size_t j = 0; j < copy.columns; ++j)
      copy(i, j) = a(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  return copy;
}

}  // namespace

DenseMatrix transpose(const DenseMatrix& a) {
  DenseMatrix result(a.columns, a.rows);
  for (std::size_t i = 0; i < a.rows; ++i)
    for (std::size_t j = 0; j < a.columns; ++j) result(j, i) = a(i, j);
  return result;
}

DenseMatrix multiply(const DenseMatrix& a, const DenseMatrix& b) {
  assert(a.columns == b.rows);
  DenseMatrix result(a.rows, b.columns);
  for (std::size_t i = 0; i < a.rows; ++i) {
    const std::span<double> sums = result.row(i);
    for (std::size_t k = 0; k < a.columns; ++k) {
      const double factor = a(i, k);
      const std::span<const double> terms = b.row(k);
      for (std::size_t j = 0; j < b.columns; ++j) sums[j] += factor * terms[j];
    }
  }
  return result;
}

DenseMatrix solve_linear(const DenseMatrix& a, const DenseMatrix& b) {
  assert(a.rows == a.columns && a.rows == b.rows);
  return from_columns(to_columns(a).fullPivLu().solve(to_columns(b)));
}

std::vector<float> solve_linear(const BasicDenseMatrix<float>& a, std::span<const float> b) {
  assert(a.rows == a.columns && a.rows == b.size());
  const Eigen::VectorXf x = to_columns(a).partialPivLu().solve(
      Eigen::Map<const Eigen::VectorXf>(b.data(), static_cast<Eigen::Index>(b.size())));
  return {x.begin(), x.end()};
}

DenseMatrix solve_least_squares(const DenseMatrix& a, const DenseMatrix& b) {
  assert(a.rows >= a.columns && a.rows == b.rows);
  return from_columns(to_columns(a).colPivHouseholderQr().solve(to_columns(b)));
}

std::vector<double> singular_values(const DenseMatrix& a) {
  // Those of the small triangle R of a = Q R.
  const Eigen::MatrixXd tall = to_columns(a.rows < a.columns ? transpose(a) : a);
  const Eigen::MatrixXd triangle =
      tall.colPivHouseholderQr().matrixR().topRows(tall.cols()).triangularView<Eigen::Upper>();
  const Eigen::VectorXd values =
      Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::NoQRPreconditioner>(triangle).singularValues();
  return {values.begin(), values.end()};
}

}  // namespace lamina
