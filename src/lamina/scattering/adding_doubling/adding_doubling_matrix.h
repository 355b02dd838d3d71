// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace lamina::detail {

/// A dense matrix, column after column.
struct Matrix {
  std::size_t rows = 0, columns = 0;
  std::vector<double> values;  ///< [column][row]

  Matrix() = default;
  Matrix(std::size_t row_count, std::size_t column_count)
      : rows(row_count), columns(column_count), values(row_count * column_count) {}
  [[nodiscard]] double& operator()(std::size_t i, std::size_t j) { return values[j * rows + i]; }
  [[nodiscard]] double operator()(std::size_t i, std::size_t j) const {
    return values[j * rows + i];
  }
};

/// A homogeneous slab, to be built by doubling a thin one.
///
/// The states hold flux over the square root of the node's etendue. In these units reciprocity
/// makes the operators symmetric up to the sign of the states: M(i, j) = s(i) s(j) M(j, i), with
/// s = +1 for the first `even` states and -1 for the rest (the odd azimuthal modes).
struct SlabProblem {
  int size = 0;
  int even = 0;                      ///< number of states of sign +1; they come first
  const double* forward = nullptr;   ///< A of dF+/dz = A F+ + B F-, -dF-/dz = B F+ + A F-
  const double* backward = nullptr;  ///< B
  double step = 0.0;                 ///< thickness to start from; step * |A| <= 1 or so
  int doublings = 0;
  /// Square roots of the states' etendues if the slab absorbs nothing, else null. Then the light
  /// that rounding loses goes straight on: a gain of 1e-16 would make a slab of 1e8 mean paths a
  /// laser.
  const double* conserved = nullptr;
  double opaque = 0.0;  ///< doubling stops early once no transmission exceeds this
};

/// The heavy matrix work of adding-doubling, compiled once for each kind of processor.
struct MatrixKernels {
  const char* name;  ///< "x86-64-v4", "x86-64-v3" or "baseline"

  /// Reflection and transmission of a slab, each [size x size]. Returns the doublings done.
  int (*slab)(const SlabProblem& problem, double* reflection, double* transmission);

  /// Several slabs of the same states and signs, without `conserved`, `lanes` of them at once; some
  /// two times faster each. In half-spaces all are doubled until each is opaque.
  int lanes;
  void (*slabs)(const SlabProblem* problems, int count, double* const* reflection,
                double* const* transmission);

  /// out = inverse of (1 - a b), all [size x size]: light between two reflectors.
  void (*joint)(int size, const double* a, const double* b, double* out);

  /// out = a b for a [rows x inner] and b [inner x columns].
  void (*multiply)(int rows, int inner, int columns, const double* a, const double* b, double* out);
};

/// The kernels for the processor that runs this.
[[nodiscard]] const MatrixKernels& matrix_kernels();

/// All that this processor can run, the best one first.
[[nodiscard]] std::vector<const MatrixKernels*> runnable_matrix_kernels();

[[nodiscard]] Matrix product(const Matrix& a, const Matrix& b);
[[nodiscard]] std::vector<double> product(const Matrix& m, const std::vector<double>& x);

/// Light between two reflectors: inverse of (1 - a b).
[[nodiscard]] Matrix between(const Matrix& a, const Matrix& b);

}  // namespace lamina::detail
