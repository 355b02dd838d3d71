// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/internal/operator_powers.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamina::detail {
namespace {

/// Coefficients of Chebyshev polynomials, [degree][column], of a function known at Chebyshev
/// points.
ValuesOfRows chebyshev_series(const ValuesOfRows& at_points) {
  const std::size_t n = at_points.size(), columns = at_points[0].size();
  ValuesOfRows series(n, std::vector<double>(columns, 0.0));
  for (std::size_t degree = 0; degree < n; ++degree)
    for (std::size_t i = 0; i < n; ++i) {
      const double angle =
          std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(n);
      const double share = (degree == 0 ? 1.0 : 2.0) / static_cast<double>(n) *
                           std::cos(static_cast<double>(degree) * angle);
      for (std::size_t c = 0; c < columns; ++c) series[degree][c] += share * at_points[i][c];
    }
  return series;
}

/// The same function as coefficients of powers.
ValuesOfRows powers_of(const ValuesOfRows& series) {
  const std::size_t n = series.size(), columns = series[0].size();
  ValuesOfRows powers(n, std::vector<double>(columns, 0.0));
  std::vector<double> before, current = {1.0};  // T_(degree-1), T_degree by powers
  for (std::size_t degree = 0; degree < n; ++degree) {
    for (std::size_t p = 0; p < current.size(); ++p)
      for (std::size_t c = 0; c < columns; ++c) powers[p][c] += current[p] * series[degree][c];
    std::vector<double> next(current.size() + 1, 0.0);  // 2 x T_degree - T_(degree-1)
    for (std::size_t p = 0; p < current.size(); ++p)
      next[p + 1] += (degree == 0 ? 1.0 : 2.0) * current[p];
    for (std::size_t p = 0; p < before.size(); ++p) next[p] -= before[p];
    before = std::move(current);
    current = std::move(next);
  }
  return powers;
}

/// Largest transform over spatial frequency of a row of weights.
double largest_transform(const std::vector<double>& weights, const std::vector<double>& variances) {
  double largest = 0.0;
  for (const double k : compared_frequencies)
    largest = std::max(largest, std::abs(transform(weights, variances, k)));
  return largest;
}

/// Degrees needed for the rest of the series to stay below the tolerance, at least 1.
std::size_t needed_degrees(const ValuesOfRows& series, const std::vector<double>& variances,
                           double tolerance) {
  double rest = 0.0;
  for (std::size_t degree = series.size(); degree-- > 1;) {
    rest += largest_transform(series[degree], variances);
    if (rest > tolerance) return degree + 1;
  }
  return 1;
}

}  // namespace

MappedOperator on_scales(const ValuesOfRows& terms, std::span<const double> scales) {
  const std::size_t gaussians = terms[0].size(), scale_count = scales.size() / gaussians;
  MappedOperator result{.terms = terms.size(),
                        .weights = std::vector<float>(terms.size() * scale_count),
                        .totals = {}};
  for (std::size_t p = 0; p < terms.size(); ++p) {
    double total = 0.0;
    for (std::size_t j = 0; j < scale_count; ++j) {
      double weight = 0.0;
      for (std::size_t i = 0; i < gaussians; ++i)
        weight += terms[p][i] * scales[i * scale_count + j];
      result.weights[p * scale_count + j] = static_cast<float>(weight);
      total += weight;
    }
    result.totals.push_back(static_cast<float>(total));
  }
  return result;
}

MappedOperator fit_powers(const std::function<std::vector<double>(double)>& weights_of,
                          const std::vector<double>& variances, std::span<const double> scales,
                          double tolerance) {
  ValuesOfRows at_points;
  double largest_total = 0.0;
  for (std::size_t i = 0; i < most_powers; ++i) {
    const double x = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.5) / most_powers);
    at_points.push_back(weights_of(x));
    largest_total = std::max(largest_total, largest_transform(at_points.back(), variances));
  }
  ValuesOfRows series = chebyshev_series(at_points);
  series.resize(needed_degrees(series, variances, tolerance * largest_total));
  return on_scales(powers_of(series), scales);
}

}  // namespace lamina::detail
