// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/core/chebyshev_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lamina {
namespace {

constexpr double narrowest = 1e-6;  // half a width, so that nothing is divided by none

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
  double sum = 0.0;
  Point by = {};
  const double* c = coefficients_.data();
  for (int k = 0; k < counts_[2]; ++k) {
    double plane = 0.0, plane_by_0 = 0.0, plane_by_1 = 0.0;
    for (int j = 0; j < counts_[1]; ++j, c += counts_[0]) {
      double row = 0.0, row_by_0 = 0.0;
      for (int i = 0; i < counts_[0]; ++i) row += c[i] * value[0][i];
      if (derivatives)
        for (int i = 0; i < counts_[0]; ++i) row_by_0 += c[i] * slope[0][i];
      plane += row * value[1][j];
      if (!derivatives) continue;
      plane_by_0 += row_by_0 * value[1][j];
      plane_by_1 += row * slope[1][j];
    }
    sum += plane * value[2][k];
    if (!derivatives) continue;
    by[0] += plane_by_0 * value[2][k];
    by[1] += plane_by_1 * value[2][k];
    by[2] += plane * slope[2][k];
  }
  if (derivatives)
    for (std::size_t d = 0; d < dimensions; ++d) (*derivatives)[d] = by[d] / width[d] * inside[d];
  return sum;
}

ChebyshevTable ChebyshevTable::over(const Box& box, const Counts& counts) const {
  std::vector<double> values = coefficients_;
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
