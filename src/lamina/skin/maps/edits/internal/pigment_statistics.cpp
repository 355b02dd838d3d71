// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/edits/internal/pigment_statistics.h"

#include <cmath>

#include "lamina/base/core/symmetric_eigen.h"

namespace lamina::skin_edits {
namespace {

constexpr double least_variance = 1e-10;  // of a coordinate; below, rounding of a constant

/// A symmetric matrix of which each eigenvalue is replaced.
template <class Function>
DenseMatrix of_eigenvalues(const DenseMatrix& a, const Function& function) {
  const SymmetricEigen eigen = symmetric_eigen(a);
  DenseMatrix result(a.rows, a.rows);
  for (std::size_t k = 0; k < a.rows; ++k) {
    const double value = function(eigen.values[k]);
    for (std::size_t i = 0; i < a.rows; ++i)
      for (std::size_t j = 0; j < a.rows; ++j)
        result(i, j) += value * eigen.vectors(i, k) * eigen.vectors(j, k);
  }
  return result;
}

}  // namespace

CoordinateStatistics statistics_of(const std::vector<std::vector<float>>& coordinates,
                                   std::span<const float> weights) {
  const std::size_t n = coordinates.size();
  CoordinateStatistics result{std::vector<double>(n, 0.0), DenseMatrix(n, n)};
  std::size_t texels = 1;
  for (const auto& each : coordinates) texels = std::max(texels, each.size());
  const auto weight = [&](std::size_t t) {
    return weights.empty() ? 1.0 : static_cast<double>(weights[t]);
  };
  const auto at = [&](std::size_t i, std::size_t t) {
    return static_cast<double>(coordinates[i][coordinates[i].size() == 1 ? 0 : t]);
  };
  double sum = 0.0;
  for (std::size_t t = 0; t < texels; ++t) {
    sum += weight(t);
    for (std::size_t i = 0; i < n; ++i) result.mean[i] += weight(t) * at(i, t);
  }
  for (double& mean : result.mean) mean /= sum;
  std::vector<double> off(n);
  for (std::size_t t = 0; t < texels; ++t) {
    for (std::size_t i = 0; i < n; ++i) off[i] = at(i, t) - result.mean[i];
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j <= i; ++j)
        result.covariance(i, j) += weight(t) / sum * off[i] * off[j];
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      // What one number is the same everywhere of has no part in the other, but for rounding.
      if (coordinates[i].size() == 1 || coordinates[j].size() == 1) result.covariance(i, j) = 0.0;
      result.covariance(j, i) = result.covariance(i, j);
    }
  for (std::size_t i = 0; i < n; ++i)
    if (coordinates[i].size() == 1) result.covariance(i, i) = 0.0;
  return result;
}

DenseMatrix transport_between(const DenseMatrix& from, const DenseMatrix& to) {
  const auto root = [](double value) { return value > least_variance ? std::sqrt(value) : 0.0; };
  const auto inverse_root = [](double value) {
    return value > least_variance ? 1.0 / std::sqrt(value) : 0.0;
  };
  const DenseMatrix half = of_eigenvalues(from, root), back = of_eigenvalues(from, inverse_root);
  // Half and to are multiplied once each way round, so that what is within is symmetric.
  DenseMatrix within = multiply(multiply(half, to), half);
  for (std::size_t i = 0; i < within.rows; ++i)
    for (std::size_t j = 0; j < i; ++j)
      within(i, j) = within(j, i) = 0.5 * (within(i, j) + within(j, i));
  const auto real_root = [](double value) { return std::sqrt(std::max(value, 0.0)); };
  return multiply(multiply(back, of_eigenvalues(within, real_root)), back);
}

}  // namespace lamina::skin_edits
