// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/dense_matrix.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lamina/base/core/random.h"

namespace lamina {
namespace {

DenseMatrix random_matrix(std::size_t rows, std::size_t columns, std::uint64_t seed) {
  Random random(seed);
  DenseMatrix a(rows, columns);
  for (double& value : a.values) value = 2.0 * random.uniform() - 1.0;
  return a;
}

void expect_equal(const DenseMatrix& a, const DenseMatrix& b, double tolerance) {
  ASSERT_EQ(a.rows, b.rows);
  ASSERT_EQ(a.columns, b.columns);
  for (std::size_t i = 0; i < a.values.size(); ++i)
    EXPECT_NEAR(a.values[i], b.values[i], tolerance) << i;
}

TEST(DenseMatrix, IsKeptRowByRow) {
  DenseMatrix a(2, 3);
  a(1, 0) = 5.0;
  EXPECT_EQ(a.values[3], 5.0);
  EXPECT_EQ(a.row(1)[0], 5.0);
  EXPECT_EQ(transpose(a)(0, 1), 5.0);
}

TEST(DenseMatrix, ProductsAreSumsOverRowAndColumn) {
  const DenseMatrix a = random_matrix(4, 7, 1), b = random_matrix(7, 3, 2), c = multiply(a, b);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      double sum = 0.0;
      for (std::size_t k = 0; k < 7; ++k) sum += a(i, k) * b(k, j);
      EXPECT_NEAR(c(i, j), sum, 1e-15);
    }
}

TEST(LinearSolves, GiveWhatWasMultiplied) {
  const DenseMatrix a = random_matrix(9, 9, 3), x = random_matrix(9, 2, 4);
  expect_equal(solve_linear(a, multiply(a, x)), x, 1e-12);

  BasicDenseMatrix<float> single(9, 9);
  std::vector<float> right(9, 0.0f);
  for (std::size_t i = 0; i < 9; ++i)
    for (std::size_t j = 0; j < 9; ++j) {
      single(i, j) = static_cast<float>(a(i, j));
      right[i] += single(i, j) * static_cast<float>(x(j, 0));
    }
  const std::vector<float> found = solve_linear(single, right);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(found[i], x(i, 0), 1e-4);
}

TEST(LinearSolves, GiveASolutionOfASingularSystemThatHasSome) {
  DenseMatrix a = random_matrix(5, 5, 5);
  for (std::size_t j = 0; j < 5; ++j) a(4, j) = a(0, j) + a(1, j);
  const DenseMatrix right = multiply(a, random_matrix(5, 1, 6));
  expect_equal(multiply(a, solve_linear(a, right)), right, 1e-12);
}

TEST(LeastSquares, LeaveAResidualAcrossAllColumns) {
  const DenseMatrix a = random_matrix(12, 4, 7), b = random_matrix(12, 2, 8);
  DenseMatrix residual = multiply(a, solve_least_squares(a, b));
  for (std::size_t i = 0; i < b.values.size(); ++i) residual.values[i] -= b.values[i];
  for (const double value : multiply(transpose(a), residual).values) EXPECT_NEAR(value, 0.0, 1e-13);
}

TEST(SingularValues, DescendAndHoldTheNormAndTheDeterminant) {
  const DenseMatrix a = random_matrix(2, 6, 9);
  const std::vector<double> values = singular_values(a);
  ASSERT_EQ(values.size(), 2u);
  EXPECT_GT(values[0], values[1]);
  double norm = 0.0;
  for (const double value : a.values) norm += value * value;
  EXPECT_NEAR(values[0] * values[0] + values[1] * values[1], norm, 1e-12);
  const DenseMatrix gram = multiply(a, transpose(a));
  EXPECT_NEAR(values[0] * values[1], std::sqrt(gram(0, 0) * gram(1, 1) - gram(0, 1) * gram(1, 0)),
              1e-12);
}

}  // namespace
}  // namespace lamina
