// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/blurs/texel_operators.h"

#include <array>
#include <cassert>
#include <numeric>

#include "lamina/scattering/heterogeneous/blurs/internal/basis_row.h"
#include "lamina/scattering/heterogeneous/blurs/internal/gaussian_blur_grids.h"
#include "lamina/scattering/heterogeneous/blurs/internal/gaussian_blur_kernels.h"

namespace lamina {
namespace {

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

Plane made_finer(const Plane& coarse, const detail::GridStep& x, const detail::GridStep& y) {
  Plane finer = make_plane(x.fine, y.fine);
  FramedRow between(x.coarse);
  for (int at = 0; at < y.fine; ++at)
    detail::make_finer_row(coarse, x, y, at, between, row_of(finer, at));
  return finer;
}

CoarseGrids coarse_grids(const BlurPyramid& pyramid) {
  return {detail::coarse_sides(pyramid.width, pyramid.levels),
          detail::coarse_sides(pyramid.height, pyramid.levels)};
}

/// Taps from the finest grid's scale before this one to it.
std::vector<float> finest_taps(std::size_t scale) {
  return detail::gaussian_taps(finest_variances[scale] - finest_variances[scale - 1]);
}

/// What one term's weights make of the coarser scales and the mean, on the grid of level 1.
Plane sum_of_scales(const CoarseGrids& grids, const std::vector<std::array<Plane, 2>>& scales,
                    const float* weights, float mean) {
  Plane sum = make_plane(scales.back()[0].width, scales.back()[0].height,
                         weights[2 * scales.size()] * mean);
  for (std::size_t level = scales.size(); level-- > 0;) {
    if (level + 1 < scales.size())
      sum = made_finer(sum, grids.x[level + 1].step, grids.y[level + 1].step);
    for (std::size_t i = 0; i < 2; ++i)
      detail::add_row(scales[level][i].values.data(), weights[2 * level + i], sum.values.data(),
                      sum.values.size());
  }
  return sum;
}

double mean_of(const Plane& plane) {
  return std::accumulate(plane.values.begin(), plane.values.end(), 0.0) /
         static_cast<double>(plane.values.size());
}

}  // namespace

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
    const std::vector<float> taps = finest_taps(scale);
    last = blurred(scale == 1 ? input : last, taps, taps,
                   [&](int y, const float* row) { add(scale, y, row); });
  }

  const CoarseGrids grids = coarse_grids(pyramid);
  const auto coarse = coarse_scales(grids, last);
  const auto mean = static_cast<float>(mean_of(input));
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

}  // namespace lamina
