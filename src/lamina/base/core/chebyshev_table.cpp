// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/chebyshev_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lamina/base/core/internal/row_sums.h"

namespace lamina {
namespace {

constexpr double narrowest = 1e-6;  // half a width, so that nothing is divided by none
static_assert(ChebyshevTable::most_points % detail::summed_columns == 0);

double chebyshev_point(int i, int count) { return std::cos(std::numbers::pi * (i + 0.5) / count); }

/// T_n(x) and, if asked for, T_n'(x) = n U_{n-1}(x), n = 0 .. count - 1.
void chebyshev(double x, int count, double* values, double* derivatives) {
  double second_kind = 0.0, last_second_kind = 0.0;  // U_{n-1}(x), U_{n-2}(x)
  for (int n = 0; n < count; ++n) {
    values[n] = n == 0 ? 1.0 : n == 1 ? x : 2.0 * x * values[n - 1] - values[n - 2];
    if (n == 1) second_kind = 1.0;
    if (n > 1)
      last_second_kind = std::exchange(second_kind, 2.0 * x * second_kind - last_second_kind);
    if (derivatives) derivatives[n] = n * second_kind;
  }
}

/// Coefficients from values at the points, [order][point].
std::vector<double> transform(int count) {
  std::vector<double> matrix;
  for (int n = 0; n < count; ++n)
    for (int i = 0; i < count; ++i)
      matrix.push_back((n == 0 ? 1.0 : 2.0) / count *
                       std::cos(std::numbers::pi * n * (i + 0.5) / count));
  return matrix;
}

/// A matrix times each line of values along a variable; `counts` becomes that of the product.
std::vector<double> times_along(std::size_t variable, std::span<const double> matrix,
                                const std::vector<double>& values, ChebyshevTable::Counts& counts) {
  const auto size = [&](std::size_t d) { return static_cast<std::size_t>(counts[d]); };
  const std::size_t in = size(variable), out = matrix.size() / in;
  std::size_t stride = 1;
  for (std::size_t d = 0; d < variable; ++d) stride *= size(d);
  const std::size_t blocks = values.size() / (stride * in);
  std::vector<double> product(blocks * stride * out, 0.0);
  for (std::size_t block = 0; block < blocks; ++block)
    for (std::size_t o = 0; o < out; ++o)
      for (std::size_t i = 0; i < in; ++i)
        for (std::size_t s = 0; s < stride; ++s)
          product[(block * out + o) * stride + s] +=
              matrix[o * in + i] * values[(block * in + i) * stride + s];
  counts[variable] = static_cast<int>(out);
  return product;
}

}  // namespace

std::vector<double> ChebyshevTable::points(double low, double high, int count) {
  std::vector<double> points;
  for (int i = 0; i < count; ++i)
    points.push_back(0.5 * (low + high) + 0.5 * (high - low) * chebyshev_point(i, count));
  return points;
}

ChebyshevTable::ChebyshevTable(const Box& box, const Counts& counts, std::vector<double> values)
    : box_(box), counts_(counts), coefficients_(std::move(values)) {
  for (std::size_t d = 0; d < dimensions; ++d) {
    const double middle = 0.5 * (box.low[d] + box.high[d]);
    box_.low[d] = std::min(box.low[d], middle - narrowest);
    box_.high[d] = std::max(box.high[d], middle + narrowest);
    coefficients_ = times_along(d, transform(counts[d]), coefficients_, counts_);
  }
  coefficients_.resize(coefficients_.size() + detail::summed_columns);
}

double ChebyshevTable::at(const Point& point, Point* derivatives) const {
  std::array<std::array<double, most_points>, dimensions> value, slope;
  Point inside = {1.0, 1.0, 1.0}, width;
  for (std::size_t d = 0; d < dimensions; ++d) {
    width[d] = 0.5 * (box_.high[d] - box_.low[d]);
    const double x = (point[d] - box_.low[d]) / width[d] - 1.0;
    if (std::abs(x) > 1.0) inside[d] = 0.0;
    chebyshev(std::clamp(x, -1.0, 1.0), counts_[d], value[d].data(),
              derivatives ? slope[d].data() : nullptr);
  }
  const auto size = [&](std::size_t d) { return static_cast<std::size_t>(counts_[d]); };
  const std::size_t rows = size(1) * size(2);
  constexpr std::size_t most_rows = std::size_t{most_points} * most_points;
  double sum = 0.0;
  Point by = {};
  if (!derivatives) {
    std::array<double, most_rows> weights;
    for (std::size_t k = 0, r = 0; k < size(2); ++k)
      for (std::size_t j = 0; j < size(1); ++j) weights[r++] = value[1][j] * value[2][k];
    std::array<double, most_points> sums;
    detail::sum_rows(coefficients_.data(), rows, size(0), weights.data(), sums.data());
    for (std::size_t i = 0; i < size(0); ++i) sum += sums[i] * value[0][i];
    return sum;
  }
  std::array<Point, most_rows> weights;  // for the value and slopes along the other variables
  for (std::size_t k = 0, r = 0; k < size(2); ++k)
    for (std::size_t j = 0; j < size(1); ++j)
      weights[r++] = {value[1][j] * value[2][k], slope[1][j] * value[2][k],
                      value[1][j] * slope[2][k]};
  std::array<std::array<double, most_points>, 3> sums;
  detail::sum_rows_by_three(coefficients_.data(), rows, size(0), weights[0].data(), sums[0].data(),
                            most_points);
  for (std::size_t i = 0; i < size(0); ++i) {
    sum += sums[0][i] * value[0][i];
    by[0] += sums[0][i] * slope[0][i];
    by[1] += sums[1][i] * value[0][i];
    by[2] += sums[2][i] * value[0][i];
  }
  for (std::size_t d = 0; d < dimensions; ++d) (*derivatives)[d] = by[d] / width[d] * inside[d];
  return sum;
}

ChebyshevTable ChebyshevTable::over(const Box& box, const Counts& counts) const {
  std::vector<double> values(coefficients_.begin(),
                             coefficients_.end() - std::ptrdiff_t{detail::summed_columns});
  Counts size = counts_;
  for (std::size_t d = 0; d < dimensions; ++d) {
    std::vector<double> matrix;  // [point][order]
    std::array<double, most_points> order;
    for (const double at : points(box.low[d], box.high[d], counts[d])) {
      const double x = 2.0 * (at - box_.low[d]) / (box_.high[d] - box_.low[d]) - 1.0;
      chebyshev(std::clamp(x, -1.0, 1.0), counts_[d], order.data(), nullptr);
      matrix.insert(matrix.end(), order.begin(), order.begin() + counts_[d]);
    }
    values = times_along(d, matrix, values, size);
  }
  return {box, counts, std::move(values)};
}

ChebyshevTable ChebyshevTable::mixed(std::span<const ChebyshevTable> tables,
                                     std::span<const double> weights) {
  ChebyshevTable sum = tables[0];
  std::ranges::fill(sum.coefficients_, 0.0);
  for (std::size_t t = 0; t < tables.size(); ++t)
    for (std::size_t i = 0; i < sum.coefficients_.size(); ++i)
      sum.coefficients_[i] += weights[t] * tables[t].coefficients_[i];
  return sum;
}

}  // namespace lamina
