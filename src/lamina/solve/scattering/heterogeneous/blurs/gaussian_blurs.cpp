// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/blurs/gaussian_blurs.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/solve/scattering/heterogeneous/blurs/internal/gaussian_blur_grids.h"

namespace lamina {
namespace {

using detail::coarse_variances;
using detail::finest_variances;

/// Transfer of each scale at a spatial frequency [1/texel], what folds back left out, where each
/// grid is coarser by exactly two. Others differ by the fourth order in k.
std::vector<double> scale_transfers(const BlurPyramid& pyramid, double k) {
  constexpr std::array<double, 2> steps = {
      coarse_variances[0] - (finest_variances.back() + 2.0 * detail::step_variance(2.0)) / 4.0,
      coarse_variances[1] - coarse_variances[0]};
  std::vector<double> transfers;
  for (const double v : finest_variances) transfers.push_back(std::exp(-v * (1.0 - std::cos(k))));
  double down = transfers.back(), up = 1.0;
  for (int level = 1; level <= pyramid.levels; ++level) {
    const double at = k * std::ldexp(1.0, level);  // per texel of this grid
    const double step = at < 2.0 * std::numbers::pi ? std::pow(std::cos(at / 4.0), 3) : 0.0;
    down *= step;
    up *= step;
    for (const double t : steps) {
      down *= std::exp(-t * (1.0 - std::cos(at)));
      transfers.push_back(at < std::numbers::pi ? down * up : 0.0);
    }
  }
  transfers.push_back(k == 0.0 ? 1.0 : 0.0);
  return transfers;
}

/// Weights of scales, [column][scale], by least squares over frequencies.
/// @param wanted  (column, k²/2 as far as blurs on the grid can have it) -> transfer
template <class Wanted>
DenseMatrix fitted_weights(std::size_t columns, double lowest, std::size_t scale_count,
                           const detail::ScaleTransfers& transfers_at, const Wanted& wanted_at) {
  constexpr std::size_t count = 400;
  constexpr double ridge = 1e-4, weight_of_total = 100.0;
  // Rows: one per frequency, then a ridge for each scale.
  DenseMatrix given(count + 1 + scale_count, scale_count);
  DenseMatrix wanted(count + 1 + scale_count, columns);
  for (std::size_t j = 0; j <= count; ++j) {
    const double k =
        j == 0 ? 0.0 : std::numbers::pi * std::pow(lowest, 1.0 - static_cast<double>(j) / count);
    const double weight = j == 0 ? weight_of_total : 1.0;
    // k²/2 as far as blurs on the grid can have it: the mean over directions of its fourth order
    // in k is right.
    const double rise = 1.0 - std::cos(k), half_square = rise + rise * rise / 8.0;
    const std::vector<double> transfers = transfers_at(k);
    for (std::size_t i = 0; i < scale_count; ++i) given(j, i) = weight * transfers[i];
    for (std::size_t i = 0; i < columns; ++i) wanted(j, i) = weight * wanted_at(i, half_square);
  }
  for (std::size_t i = 0; i < scale_count; ++i)
    given(count + 1 + i, i) = ridge * std::sqrt(count + 1.0);
  return transpose(solve_least_squares(given, wanted));
}

double sum_of(std::span<const double> row) { return std::accumulate(row.begin(), row.end(), 0.0); }

}  // namespace

BlurPyramid make_blur_pyramid(int width, int height, double largest_variance) {
  assert(width > 0 && height > 0);
  constexpr int smallest_side = 4;
  int levels = 1;
  while (coarse_variances[1] * std::pow(4.0, levels) < largest_variance &&
         std::min(width, height) > ((smallest_side - 1) << (levels + 1)))
    ++levels;
  BlurPyramid pyramid{.width = width,
                      .height = height,
                      .levels = levels,
                      .variances = {finest_variances.begin(), finest_variances.end()}};
  for (int level = 1; level <= levels; ++level)
    for (const double v : coarse_variances) pyramid.variances.push_back(v * std::pow(4.0, level));
  pyramid.variances.push_back(std::numeric_limits<double>::infinity());
  return pyramid;
}

std::vector<double> detail::fit_scales(std::span<const double> variances, double lowest,
                                       std::size_t scale_count,
                                       const ScaleTransfers& transfers_at) {
  const DenseMatrix weights = fitted_weights(
      variances.size(), lowest, scale_count, transfers_at,
      [&](std::size_t i, double half_square) { return std::exp(-variances[i] * half_square); });
  std::vector<double> result;
  for (std::size_t i = 0; i < variances.size(); ++i) {
    const double sum = sum_of(weights.row(i));
    for (const double weight : weights.row(i)) result.push_back(weight / sum);
  }
  return result;
}

std::vector<double> scales_of_gaussians(const BlurPyramid& pyramid,
                                        std::span<const double> variances) {
  return detail::fit_scales(variances, 1.0 / std::max(pyramid.width, pyramid.height),
                            pyramid.variances.size(),
                            [&](double k) { return scale_transfers(pyramid, k); });
}

std::vector<double> scale_slopes(const BlurPyramid& pyramid, double variance) {
  const DenseMatrix weights = fitted_weights(
      2, 1.0 / std::max(pyramid.width, pyramid.height), pyramid.variances.size(),
      [&](double k) { return scale_transfers(pyramid, k); },
      [&](std::size_t i, double half_square) {
        const double transfer = std::exp(-variance * half_square);
        return i == 0 ? transfer : -half_square * transfer;
      });
  const double sum = sum_of(weights.row(0)), slope = sum_of(weights.row(1)) / sum;
  std::vector<double> result;
  for (std::size_t i = 0; i < pyramid.variances.size(); ++i)
    result.push_back((weights(1, i) - slope * weights(0, i)) / sum);
  return result;
}

}  // namespace lamina
