// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/profile/gaussian_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace lamina {
namespace {

struct NonNegative {
  Eigen::VectorXd x;
  int iterations;
  bool converged;
};

/// min |A x - b| over x >= 0: variables enter the free set one by one, the one with the steepest
/// descent first, and leave it where the free solution would turn negative.
NonNegative nonnegative_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  const Eigen::Index n = A.cols();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Index> free;
  const double tolerance = 1e-13 * (A.transpose() * b).cwiseAbs().maxCoeff();
  const auto solve_free = [&] {
    Eigen::MatrixXd columns(A.rows(), static_cast<Eigen::Index>(free.size()));
    for (std::size_t i = 0; i < free.size(); ++i)
      columns.col(static_cast<Eigen::Index>(i)) = A.col(free[i]);
    return Eigen::VectorXd(columns.colPivHouseholderQr().solve(b));
  };
  for (int iteration = 0; iteration < 30 * static_cast<int>(n); ++iteration) {
    const Eigen::VectorXd descent = A.transpose() * (b - A * x);
    Eigen::Index enter = -1;
    for (Eigen::Index i = 0; i < n; ++i)
      if (std::ranges::find(free, i) == free.end() && descent[i] > tolerance &&
          (enter < 0 || descent[i] > descent[enter]))
        enter = i;
    if (enter < 0) return {x, iteration, true};
    free.push_back(enter);
    Eigen::VectorXd solution = solve_free();
    while (solution.minCoeff() <= 0.0) {
      // Go as far as all stay >= 0; those that reach 0 are bound again.
      double step = 1.0;
      for (std::size_t i = 0; i < free.size(); ++i) {
        const double to = solution[static_cast<Eigen::Index>(i)], from = x[free[i]];
        if (to <= 0.0) step = std::min(step, from / (from - to));
      }
      for (std::size_t i = 0; i < free.size(); ++i)
        x[free[i]] += step * (solution[static_cast<Eigen::Index>(i)] - x[free[i]]);
      std::erase_if(free, [&](Eigen::Index i) {
        const bool is_bound = x[i] <= 1e-15;
        if (is_bound) x[i] = 0.0;
        return is_bound;
      });
      if (free.empty()) return {x, iteration, true};
      solution = solve_free();
    }
    for (std::size_t i = 0; i < free.size(); ++i)
      x[free[i]] = solution[static_cast<Eigen::Index>(i)];
  }
  return {x, 30 * static_cast<int>(n), false};
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
  Eigen::MatrixXd A(static_cast<Eigen::Index>(k.size()),
                    static_cast<Eigen::Index>(variances.size()));
  Eigen::VectorXd b(static_cast<Eigen::Index>(k.size()));
  for (Eigen::Index j = 0; j < A.rows(); ++j) {
    const double at = k[static_cast<std::size_t>(j)];
    for (Eigen::Index i = 0; i < A.cols(); ++i)
      A(j, i) = std::exp(-0.5 * at * at * variances[static_cast<std::size_t>(i)]);
    b[j] = spectrum[static_cast<std::size_t>(j)];
  }
  const NonNegative found = nonnegative_least_squares(A, b);
  const Eigen::VectorXd residual = A * found.x - b;
  const double scale = std::max(b.cwiseAbs().maxCoeff(), 1e-300);
  return {.sum = {.variances = {variances.begin(), variances.end()},
                  .weights = {found.x.begin(), found.x.end()}},
          .rms_error = residual.norm() / std::sqrt(static_cast<double>(k.size())) / scale,
          .largest_error = residual.cwiseAbs().maxCoeff() / scale,
          .iterations = found.iterations,
          .converged = found.converged};
}

}  // namespace lamina
