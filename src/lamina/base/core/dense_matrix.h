// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lamina {

/// A matrix of run-time size, row by row. For set-up work: fits, weights, small systems. Eigen does
/// what is hard, in one source of its own.
template <class T>
struct BasicDenseMatrix {
  std::size_t rows = 0, columns = 0;
  std::vector<T> values;  ///< [row][column]

  BasicDenseMatrix() = default;
  BasicDenseMatrix(std::size_t row_count, std::size_t column_count)
      : rows(row_count), columns(column_count), values(row_count * column_count) {}

  T& operator()(std::size_t row, std::size_t column) { return values[row * columns + column]; }
  T operator()(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
  std::span<T> row(std::size_t i) { return {values.data() + i * columns, columns}; }
  std::span<const T> row(std::size_t i) const { return {values.data() + i * columns, columns}; }
};
using DenseMatrix = BasicDenseMatrix<double>;

[[nodiscard]] DenseMatrix transpose(const DenseMatrix& a);

/// a b; the columns of a are as many as the rows of b.
[[nodiscard]] DenseMatrix multiply(const DenseMatrix& a, const DenseMatrix& b);

/// x of a x = b, for each column of b: LU with full pivoting. Where a, square, is singular, x is
/// one of the solutions if there are any.
[[nodiscard]] DenseMatrix solve_linear(const DenseMatrix& a, const DenseMatrix& b);

/// Solves by LU with partial pivoting in single precision, quick for large systems; a is regular.
[[nodiscard]] std::vector<float> solve_linear(const BasicDenseMatrix<float>& a,
                                              std::span<const float> b);

/// x of least |a x - b| for each column of b, rows of a >= columns: QR with column pivoting.
[[nodiscard]] DenseMatrix solve_least_squares(const DenseMatrix& a, const DenseMatrix& b);

/// Descending, min(rows, columns) of them: Jacobi rotations after a QR decomposition.
[[nodiscard]] std::vector<double> singular_values(const DenseMatrix& a);

}  // namespace lamina
