// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/profile/gaussian_fit.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "lamina/base/core/dense_matrix.h"

namespace lamina {
namespace {

struct NonNegative {
  std::vector<double> x;
  int iterations;
  bool converged;
};

/// b - A x
std::vector<double> residual_of(const DenseMatrix& A, std::span<const double> x,
                                std::span<const double> b) {
  std::vector<double> residual(b.begin(), b.end());
  for (std::size_t j = 0; j < A.rows; ++j)
    residual[j] -= std::inner_product(x.begin(), x.end(), A.row(j).begin(), 0.0);
  return residual;
}

/// A' y
std::vector<double> projected(const DenseMatrix& A, std::span<const double> y) {
  std::vector<double> sums(A.columns, 0.0);
  for (std::size_t j = 0; j < A.rows; ++j)
    for (std::size_t i = 0; i < A.columns; ++i) sums[i] += A(j, i) * y[j];
  return sums;
}

double largest_magnitude(std::span<const double> values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// min |A x - b| over x >= 0: variables enter the free set one by one, the one with the steepest
/// descent first, and leave it where the free solution would turn negative.
NonNegative nonnegative_least_squares(const DenseMatrix& A, const std::vector<double>& b) {
  const std::size_t n = A.columns;
  std::vector<double> x(n, 0.0);
  std::vector<std::size_t> free;
  const double tolerance = 1e-13 * largest_magnitude(projected(A, b));
  DenseMatrix right(A.rows, 1);
  right.values = b;
  const auto solve_free = [&] {
    DenseMatrix columns(A.rows, free.size());
    for (std::size_t j = 0; j < A.rows; ++j)
      for (std::size_t i = 0; i < free.size(); ++i) columns(j, i) = A(j, free[i]);
    return solve_least_squares(columns, right).values;
  };
  const int most = 30 * static_cast<int>(n);
  for (int iteration = 0; iteration < most; ++iteration) {
    const std::vector<double> descent = projected(A, residual_of(A, x, b));
    std::size_t enter = n;
    for (std::size_t i = 0; i < n; ++i)
      if (std::ranges::find(free, i) == free.end() && descent[i] > tolerance &&
          (enter == n || descent[i] > descent[enter]))
        enter = i;
    if (enter == n) return {x, iteration, true};
    free.push_back(enter);
    std::vector<double> solution = solve_free();
    while (std::ranges::min(solution) <= 0.0) {
      // Go as far as all stay >= 0; those that reach 0 are bound again.
      double step = 1.0;
      for (std::size_t i = 0; i < free.size(); ++i) {
        const double to = solution[i], from = x[free[i]];
        if (to <= 0.0) step = std::min(step, from / (from - to));
      }
      for (std::size_t i = 0; i < free.size(); ++i) x[free[i]] += step * (solution[i] - x[free[i]]);
      std::erase_if(free, [&](std::size_t i) {
        const bool is_bound = x[i] <= 1e-15;
        if (is_bound) x[i] = 0.0;
        return is_bound;
      });
      if (free.empty()) return {x, iteration, true};
      solution = solve_free();
    }
    for (std::size_t i = 0; i < free.size(); ++i) x[free[i]] = solution[i];
  }
  return {x, most, false};
}

}  // namespace

double evaluate(const GaussianSum& sum, double r) {
  double value = 0.0;
  for (std::size_t i = 0; i < sum.variances.size(); ++i)
    if (const double v = sum.variances[i]; v > 0.0)
      value += sum.weights[i] * std::exp(-0.5 * r * r / v) / (2.0 * std::numbers::pi * v);
  return value;
}

double evaluate_at_frequency(const GaussianSum& sum, double k) {
  double value = 0.0;
  for (std::size_t i = 0; i < sum.variances.size(); ++i)
    value += sum.weights[i] * std::exp(-0.5 * k * k * sum.variances[i]);
  return value;
}

std::vector<double> doubling_variances(double first, int count) {
  std::vector<double> variances = {0.0};
  for (int i = 0; i < count; ++i) variances.push_back(std::ldexp(first, i));
  return variances;
}

std::vector<double> fit_frequencies(std::span<const double> variances, std::size_t count) {
  double narrowest = 0.0, widest = 0.0;
  for (const double v : variances) {
    if (v <= 0.0) continue;
    narrowest = narrowest > 0.0 ? std::min(narrowest, v) : v;
    widest = std::max(widest, v);
  }
  if (widest == 0.0) return {0.0, 1.0};
  const double first = 0.05 / std::sqrt(widest), last = 5.0 / std::sqrt(narrowest);
  std::vector<double> k = {0.0};
  for (std::size_t i = 0; i < count; ++i)
    k.push_back(first * std::pow(last / first,
                                 static_cast<double>(i) /
                                     static_cast<double>(std::max<std::size_t>(count - 1, 1))));
  return k;
}

GaussianFit fit_gaussians(std::span<const double> spectrum, std::span<const double> k,
                          std::span<const double> variances) {
  assert(spectrum.size() == k.size() && !k.empty() && !variances.empty());
  DenseMatrix A(k.size(), variances.size());
  for (std::size_t j = 0; j < A.rows; ++j)
    for (std::size_t i = 0; i < A.columns; ++i)
      A(j, i) = std::exp(-0.5 * k[j] * k[j] * variances[i]);
  const std::vector<double> b(spectrum.begin(), spectrum.end());
  NonNegative found = nonnegative_least_squares(A, b);
  const std::vector<double> residual = residual_of(A, found.x, b);
  const double scale = std::max(largest_magnitude(b), 1e-300);
  const double square = std::inner_product(residual.begin(), residual.end(), residual.begin(), 0.0);
  return {.sum = {.variances = {variances.begin(), variances.end()}, .weights = std::move(found.x)},
          .rms_error = std::sqrt(square / static_cast<double>(k.size())) / scale,
          .largest_error = largest_magnitude(residual) / scale,
          .iterations = found.iterations,
          .converged = found.converged};
}

}  // namespace lamina
