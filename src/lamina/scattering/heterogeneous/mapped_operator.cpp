// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/mapped_operator.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamina {
namespace {

constexpr std::size_t most_powers = 20;

using ValuesOfRows = std::vector<std::vector<double>>;

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
  for (const double k : {0.0, 0.1, 0.2, 0.4, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 20.0,
                         40.0, 80.0, 160.0}) {
    double sum = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i)
      sum += weights[i] * std::exp(-0.5 * k * k * variances[i]);
    largest = std::max(largest, std::abs(sum));
  }
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

AbsorptionRange absorption_range(const Plane& sigma_a, const GaussianTableGrid& grid) {
  const auto [lowest, highest] = std::minmax_element(sigma_a.values.begin(), sigma_a.values.end());
  return {std::clamp<double>(*lowest, grid.lowest, grid.highest),
          std::clamp<double>(*highest, grid.lowest, grid.highest)};
}

Plane absorption_coordinate(const Plane& sigma_a, const AbsorptionRange& range) {
  Plane result = make_plane(sigma_a.width, sigma_a.height);
  const auto low = static_cast<float>(std::sqrt(range.lowest));
  const auto width = static_cast<float>(std::sqrt(range.highest)) - low;
  if (width < 1e-6f * low) return result;
  for (std::size_t i = 0; i < result.values.size(); ++i)
    result.values[i] =
        std::clamp(2.0f * (std::sqrt(sigma_a.values[i]) - low) / width - 1.0f, -1.0f, 1.0f);
  return result;
}

MappedOperator make_mapped_operator(const StackTables& tables, const GaussianTable& table,
                                    const AbsorptionRange& range, std::span<const double> scales,
                                    double tolerance) {
  const double low = std::sqrt(range.lowest), high = std::sqrt(range.highest);
  ValuesOfRows at_points;
  double largest_total = 0.0;
  for (std::size_t i = 0; i < most_powers; ++i) {
    const double x = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.5) / most_powers);
    const double root = 0.5 * (low + high) + 0.5 * (high - low) * x;
    at_points.push_back(weights_at(tables, table, root * root));
    largest_total = std::max(largest_total, largest_transform(at_points.back(), tables.variances));
  }
  ValuesOfRows series = chebyshev_series(at_points);
  series.resize(needed_degrees(series, tables.variances, tolerance * largest_total));
  const ValuesOfRows powers = powers_of(series);

  const std::size_t scale_count = scales.size() / tables.variances.size();
  MappedOperator result{.powers = powers.size(),
                        .weights = std::vector<float>(powers.size() * scale_count),
                        .totals = {}};
  for (std::size_t p = 0; p < powers.size(); ++p) {
    double total = 0.0;
    for (std::size_t j = 0; j < scale_count; ++j) {
      double weight = 0.0;
      for (std::size_t i = 0; i < tables.variances.size(); ++i)
        weight += powers[p][i] * scales[i * scale_count + j];
      result.weights[p * scale_count + j] = static_cast<float>(weight);
      total += weight;
    }
    result.totals.push_back(static_cast<float>(total));
  }
  return result;
}

}  // namespace lamina
