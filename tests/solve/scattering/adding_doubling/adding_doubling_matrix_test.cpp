// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/adding_doubling_matrix.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>

#include "solve/scattering/only_target.h"

namespace lamina::detail {
namespace {

/// Entries of either sign that no pattern of the kernels divides.
Matrix filled(std::size_t rows, std::size_t columns, double scale) {
  Matrix m(rows, columns);
  for (std::size_t j = 0; j < columns; ++j)
    for (std::size_t i = 0; i < rows; ++i)
      m(i, j) = scale * std::sin(static_cast<double>(3 * i + 7 * j) + 0.1 * scale);
  return m;
}

Matrix literal_product(const Matrix& a, const Matrix& b) {
  Matrix out(a.rows, b.columns);
  for (std::size_t i = 0; i < a.rows; ++i)
    for (std::size_t j = 0; j < b.columns; ++j)
      for (std::size_t q = 0; q < a.columns; ++q) out(i, j) += a(i, q) * b(q, j);
  return out;
}

double largest_difference(const Matrix& a, const Matrix& b) {
  EXPECT_EQ(a.rows, b.rows);
  EXPECT_EQ(a.columns, b.columns);
  double largest = 0.0;
  for (std::size_t k = 0; k < a.values.size(); ++k)
    largest = std::max(largest, std::abs(a.values[k] - b.values[k]));
  return largest;
}

// Sizes below, at and beyond those of vectors, tiles and blocks.
constexpr std::size_t sizes[] = {1, 2, 3, 4, 5, 7, 8, 9, 12, 16, 17, 31, 50};

TEST(DenseMatrix, ProductIsThatOfTheDefinitionOnEveryTarget) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const OnlyTarget only(target);
    for (const std::size_t rows : sizes)
      for (const std::size_t columns : sizes) {
        const std::size_t inner = 1 + (rows + columns) % 19;
        const Matrix a = filled(rows, inner, 0.9), b = filled(inner, columns, 1.1);
        EXPECT_LT(largest_difference(product(a, b), literal_product(a, b)), 1e-14)
            << rows << " " << inner << " " << columns << " " << hwy::TargetName(target);
      }
  }
}

// (1 - a b) times its inverse is 1: also where the diagonal vanishes, so that rows must change
// places.
TEST(DenseMatrix, LightBetweenReflectorsIsTheInverseOnEveryTarget) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const OnlyTarget only(target);
    for (const std::size_t n : sizes) {
      Matrix one(n, n), cyclic(n, n);
      for (std::size_t i = 0; i < n; ++i) {
        one(i, i) = 1.0;
        cyclic(i, i) += 1.0;  // 1 - this has a diagonal of zeros
        cyclic((i + 1) % n, i) -= n > 1 ? 2.0 : 0.5;
      }
      for (const Matrix& a : {filled(n, n, 0.5 / static_cast<double>(n)), cyclic}) {
        Matrix system = literal_product(a, one);
        for (std::size_t k = 0; k < n * n; ++k) system.values[k] = one.values[k] - system.values[k];
        EXPECT_LT(largest_difference(literal_product(system, between(a, one)), one), 1e-13)
            << n << " " << hwy::TargetName(target);
      }
    }
  }
}

/// A slab of n states that scatters and absorbs, the last ones of the odd modes.
struct Slab {
  Matrix forward, backward;
  SlabProblem problem;
};
Slab absorbing_slab(std::size_t n, std::size_t even) {
  Slab slab{Matrix(n, n), Matrix(n, n), {}};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const bool differ = (i < even) != (j < even);
      const double weight = (differ && i < j ? -0.3 : 0.3) / static_cast<double>(n);
      slab.forward(i, j) = weight * (1.0 + 0.3 * std::cos(static_cast<double>(i * j)));
      slab.backward(i, j) = differ ? 0.0 : weight * std::cos(static_cast<double>(i + j));
      if (i == j) slab.forward(i, j) -= 1.0 + 0.05 * static_cast<double>(i);
    }
  slab.problem = {
      .size = static_cast<int>(n), .even = static_cast<int>(even), .step = 0.2, .doublings = 5};
  return slab;
}

TEST(SlabDoubling, EveryTargetGivesTheSameOperators) {
  for (const std::size_t n : sizes)
    for (const std::size_t even : {n, (n + 1) / 2}) {
      Slab slab = absorbing_slab(n, even);
      slab.problem.forward = slab.forward.values.data();
      slab.problem.backward = slab.backward.values.data();
      Matrix first_r(n, n), first_t(n, n);
      bool is_first = true;
      for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        const OnlyTarget only(target);
        Matrix r(n, n), t(n, n);
        EXPECT_EQ(double_slab(slab.problem, r.values.data(), t.values.data()), 5);
        if (is_first) {
          first_r = r;
          first_t = t;
          is_first = false;
        }
        EXPECT_LT(largest_difference(r, first_r), 1e-14) << n << " " << hwy::TargetName(target);
        EXPECT_LT(largest_difference(t, first_t), 1e-14) << n << " " << hwy::TargetName(target);
      }
    }
}

}  // namespace
}  // namespace lamina::detail
