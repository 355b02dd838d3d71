// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
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

/// Reflection and transmission of a slab, each [size x size]. Returns the doublings done.
int double_slab(const SlabProblem& problem, double* reflection, double* transmission);

/// Derivatives of the matrices of a SlabProblem by one parameter, the step kept.
struct SlabProblemDerivative {
  const double* forward = nullptr;   ///< of A
  const double* backward = nullptr;  ///< of B
};

/// Reflection and transmission of a slab with their derivatives.
struct DifferentiatedSlab {
  Matrix reflection, transmission;
  std::vector<Matrix> reflection_derivatives, transmission_derivatives;  ///< [parameter]
};
/// Doubling with derivatives, for some two times the work for each parameter and the slab.
[[nodiscard]] DifferentiatedSlab double_slab_with_derivatives(
    const SlabProblem& problem, std::span<const SlabProblemDerivative> derivatives);

/// Several slabs of the same states and signs, without `conserved`; up to some 60 states faster
/// each in groups of `slabs_at_once`, which depends on the processor. In half-spaces all of a group
/// are doubled until each is opaque.
void double_slabs(std::span<const SlabProblem> problems, double* const* reflection,
                  double* const* transmission);
[[nodiscard]] std::size_t slabs_at_once();

/// Reflection and transmission of slabs of 1, 2, 4, ... 2^(rungs - 1) times a thickness, which the
/// doublings of the last pass by. The problems are those of the thickest.
/// @param reflection, transmission  [rung][problem], each [size x size]
void double_slab_ladder(std::span<const SlabProblem> problems, std::size_t rungs,
                        double* const* reflection, double* const* transmission);

[[nodiscard]] Matrix product(const Matrix& a, const Matrix& b);
[[nodiscard]] std::vector<double> product(const Matrix& m, const std::vector<double>& x);

/// Light between two reflectors: inverse of (1 - a b).
[[nodiscard]] Matrix between(const Matrix& a, const Matrix& b);

}  // namespace lamina::detail
