// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/gaussian_blurs.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "lamina/core/dense_matrix.h"
#include "lamina/scattering/heterogeneous/internal/basis_row.h"
#include "lamina/scattering/heterogeneous/internal/gaussian_blur_grids.h"
#include "lamina/scattering/heterogeneous/internal/gaussian_blur_kernels.h"

namespace lamina {
namespace {

using detail::coarse_variances;
using detail::CoarseSide;
using detail::finest_variances;
using detail::FramedRow;
using detail::row_of;

/// Blurs a plane along x and y and hands over each row as it is done.
template <class Use>
Plane blurred(const Plane& plane, const std::vector<float>& taps_x,
              const std::vector<float>& taps_y, const Use& use) {
  Plane result = make_plane(plane.width, plane.height);
  FramedRow sum(plane.width);
  const int reach = static_cast<int>(taps_y.size()) - 1;
  std::vector<const float*> rows(static_cast<std::size_t>(2 * reach + 1));
  const auto size = static_cast<std::size_t>(plane.width);
  for (int y = 0; y < plane.height; ++y) {
    for (int n = -reach; n <= reach; ++n)
      rows[static_cast<std::size_t>(n + reach)] =
          row_of(plane, detail::reflected(y + n, plane.height));
    detail::combine_rows(rows, taps_y, sum.data(), size);
    sum.mirror();
    detail::convolve_row(sum.data(), taps_x, row_of(result, y), size);
    use(y, row_of(result, y));
  }
  return result;
}

/// The coarser grids of a pyramid, [level - 1].
struct CoarseGrids {
  std::vector<CoarseSide> x, y;
};

/// The scales of the coarser grids, [level - 1], two each.
std::vector<std::array<Plane, 2>> coarse_scales(const CoarseGrids& grids, const Plane& last) {
  std::vector<std::array<Plane, 2>> scales;
  for (std::size_t i = 0; i < grids.x.size(); ++i) {
    const CoarseSide &x = grids.x[i], &y = grids.y[i];
    const auto blur = [&](const Plane& plane, std::size_t scale) {
      return blurred(plane, x.taps[scale], y.taps[scale], [](int, const float*) {});
    };
    Plane first = blur(coarsened(i == 0 ? last : scales.back()[1], x.step, y.step), 0);
    Plane second = blur(first, 1);
    scales.push_back({std::move(first), std::move(second)});
  }
  return scales;
}

/// What one power's weights make of the coarser scales and the mean, on the grid of level 1.
Plane sum_of_scales(const CoarseGrids& grids, const std::vector<std::array<Plane, 2>>& scales,
                    const float* weights, float mean) {
  Plane sum = make_plane(scales.back()[0].width, scales.back()[0].height,
                         weights[2 * scales.size()] * mean);
  for (std::size_t level = scales.size(); level-- > 0;) {
    if (level + 1 < scales.size()) {
      const detail::GridStep &x = grids.x[level + 1].step, &y = grids.y[level + 1].step;
      Plane finer = make_plane(x.fine, y.fine);
      FramedRow between(x.coarse);
      for (int at = 0; at < y.fine; ++at)
        detail::make_finer_row(sum, x, y, at, between, row_of(finer, at));
      sum = std::move(finer);
    }
    for (std::size_t i = 0; i < 2; ++i)
      detail::add_row(scales[level][i].values.data(), weights[2 * level + i], sum.values.data(),
                      sum.values.size());
  }
  return sum;
}

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
  constexpr std::size_t count = 400;
  constexpr double ridge = 1e-4, weight_of_total = 100.0;
  // Rows: one per frequency, then a ridge for each scale.
  const std::size_t gaussians = variances.size();
  DenseMatrix given(count + 1 + scale_count, scale_count);
  DenseMatrix wanted(count + 1 + scale_count, gaussians);
  for (std::size_t j = 0; j <= count; ++j) {
    const double k =
        j == 0 ? 0.0 : std::numbers::pi * std::pow(lowest, 1.0 - static_cast<double>(j) / count);
    const double weight = j == 0 ? weight_of_total : 1.0;
    // k²/2 as far as blurs on the grid can have it: the mean over directions of its fourth order
    // in k is right.
    const double rise = 1.0 - std::cos(k), half_square = rise + rise * rise / 8.0;
    const std::vector<double> transfers = transfers_at(k);
    for (std::size_t i = 0; i < scale_count; ++i) given(j, i) = weight * transfers[i];
    for (std::size_t i = 0; i < gaussians; ++i)
      wanted(j, i) = weight * std::exp(-variances[i] * half_square);
  }
  for (std::size_t i = 0; i < scale_count; ++i)
    given(count + 1 + i, i) = ridge * std::sqrt(count + 1.0);
  const DenseMatrix weights = transpose(solve_least_squares(given, wanted));
  std::vector<double> result;
  for (std::size_t i = 0; i < gaussians; ++i) {
    const double sum = std::accumulate(weights.row(i).begin(), weights.row(i).end(), 0.0);
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

std::vector<Plane> apply_operators(const BlurPyramid& pyramid, const Plane& input,
                                   const TexelBasis& basis,
                                   std::span<const MappedOperator* const> operators) {
  assert(input.width == pyramid.width && input.height == pyramid.height);
  const std::size_t scales = pyramid.variances.size();
  const auto width = static_cast<std::size_t>(pyramid.width);
  std::vector<Plane> results;
  for (std::size_t o = 0; o < operators.size(); ++o)
    results.push_back(make_plane(pyramid.width, pyramid.height));
  std::vector<float> coefficients;
  detail::BasisRow functions(basis);
  const auto add = [&](std::size_t scale, int y, const float* row) {
    functions.move_to(y);
    for (std::size_t o = 0; o < operators.size(); ++o) {
      coefficients.clear();
      for (std::size_t p = 0; p < operators[o]->terms; ++p)
        coefficients.push_back(operators[o]->weights[p * scales + scale]);
      functions.add_times_sum(row, coefficients, row_of(results[o], y), width);
    }
  };
  for (int y = 0; y < input.height; ++y) add(0, y, row_of(input, y));
  Plane last;
  for (std::size_t scale = 1; scale < finest_scales; ++scale) {
    const auto taps = detail::gaussian_taps(finest_variances[scale] - finest_variances[scale - 1]);
    last = blurred(scale == 1 ? input : last, taps, taps,
                   [&](int y, const float* row) { add(scale, y, row); });
  }

  const CoarseGrids grids = {detail::coarse_sides(pyramid.width, pyramid.levels),
                             detail::coarse_sides(pyramid.height, pyramid.levels)};
  const auto coarse = coarse_scales(grids, last);
  const double sum = std::accumulate(input.values.begin(), input.values.end(), 0.0);
  const auto mean = static_cast<float>(sum / static_cast<double>(input.values.size()));
  FramedRow between(grids.x[0].step.coarse);
  for (std::size_t o = 0; o < operators.size(); ++o) {
    std::vector<Plane> sums;
    std::vector<std::vector<float>> finer(operators[o]->terms, std::vector<float>(width));
    std::vector<const float*> rows;
    for (std::size_t p = 0; p < operators[o]->terms; ++p) {
      sums.push_back(
          sum_of_scales(grids, coarse, &operators[o]->weights[p * scales + finest_scales], mean));
      rows.push_back(finer[p].data());
    }
    for (int y = 0; y < pyramid.height; ++y) {
      for (std::size_t p = 0; p < sums.size(); ++p)
        detail::make_finer_row(sums[p], grids.x[0].step, grids.y[0].step, y, between,
                               finer[p].data());
      functions.move_to(y);
      functions.add_products(rows, row_of(results[o], y), width);
    }
  }
  return results;
}

std::vector<Plane> apply_operators_reciprocally(const BlurPyramid& pyramid, const Plane& input,
                                                const TexelBasis& basis,
                                                std::span<const MappedOperator* const> operators) {
  assert(basis.modes.empty());
  const std::size_t scales = pyramid.variances.size();
  std::size_t most_powers = 1;
  for (const MappedOperator* each : operators) most_powers = std::max(most_powers, each->terms);
  std::vector<Plane> sums;
  Plane light = input;  // times coordinate^q where it enters
  for (std::size_t q = 0; q < most_powers; ++q) {
    // What is left of each power's binomial for where light comes out.
    std::vector<MappedOperator> rest(operators.size());
    std::vector<const MappedOperator*> used;
    std::vector<std::size_t> index;
    for (std::size_t o = 0; o < operators.size(); ++o) {
      const MappedOperator& whole = *operators[o];
      if (whole.terms <= q) continue;
      rest[o].terms = whole.terms - q;
      double choose = 1.0;  // of p = q + m powers those q that belong to where light enters
      for (std::size_t m = 0; m < rest[o].terms; ++m) {
        const double p = static_cast<double>(q + m);
        if (m > 0) choose *= p / static_cast<double>(m);
        const auto share = static_cast<float>(choose * std::exp2(-p));
        for (std::size_t j = 0; j < scales; ++j)
          rest[o].weights.push_back(share * whole.weights[(q + m) * scales + j]);
      }
      used.push_back(&rest[o]);
      index.push_back(o);
    }
    std::vector<Plane> parts = apply_operators(pyramid, light, basis, used);
    if (q == 0) {
      sums = std::move(parts);
    } else {
      for (std::size_t u = 0; u < used.size(); ++u)
        for (std::size_t i = 0; i < light.values.size(); ++i)
          sums[index[u]].values[i] += parts[u].values[i];
    }
    for (std::size_t i = 0; i < light.values.size(); ++i)
      light.values[i] *= basis.coordinate.values[i];
  }
  return sums;
}

}  // namespace lamina
