// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/blurs/texel_operators.h"

#include <array>
#include <cassert>
#include <numeric>
#include <utility>

#include "lamina/solve/scattering/heterogeneous/blurs/internal/basis_row.h"
#include "lamina/solve/scattering/heterogeneous/blurs/internal/gaussian_blur_grids.h"
#include "lamina/solve/scattering/heterogeneous/blurs/internal/gaussian_blur_kernels.h"

namespace lamina {
namespace {

using detail::blur_kernels;
using detail::CoarseSide;
using detail::finest_variances;
using detail::FramedRow;
using detail::row_of;

/// Blurs a plane along x and y and hands over each row as it is done.
template <class T, class Use>
PlaneOf<T> blurred(const PlaneOf<T>& plane, const std::vector<float>& taps_x,
                   const std::vector<float>& taps_y, const Use& use) {
  PlaneOf<T> result = make_plane<T>(plane.width, plane.height);
  FramedRow<T> sum(plane.width);
  const int reach = static_cast<int>(taps_y.size()) - 1;
  std::vector<const T*> rows(static_cast<std::size_t>(2 * reach + 1));
  const auto size = static_cast<std::size_t>(plane.width);
  for (int y = 0; y < plane.height; ++y) {
    for (int n = -reach; n <= reach; ++n)
      rows[static_cast<std::size_t>(n + reach)] =
          row_of(plane, detail::reflected(y + n, plane.height));
    blur_kernels<T>().combine_rows(rows, taps_y, sum.data(), size);
    sum.mirror();
    blur_kernels<T>().convolve_row(sum.data(), taps_x, row_of(result, y), size);
    use(y, row_of(result, y));
  }
  return result;
}

/// The coarser grids of a pyramid, [level - 1].
struct CoarseGrids {
  std::vector<CoarseSide> x, y;
};

/// The scales of the coarser grids, [level - 1], two each.
template <class T>
std::vector<std::array<PlaneOf<T>, 2>> coarse_scales(const CoarseGrids& grids,
                                                     const PlaneOf<T>& last) {
  std::vector<std::array<PlaneOf<T>, 2>> scales;
  for (std::size_t i = 0; i < grids.x.size(); ++i) {
    const CoarseSide &x = grids.x[i], &y = grids.y[i];
    const auto blur = [&](const PlaneOf<T>& plane, std::size_t scale) {
      return blurred(plane, x.taps[scale], y.taps[scale], [](int, const T*) {});
    };
    PlaneOf<T> first = blur(coarsened(i == 0 ? last : scales.back()[1], x.step, y.step), 0);
    PlaneOf<T> second = blur(first, 1);
    scales.push_back({std::move(first), std::move(second)});
  }
  return scales;
}

template <class T>
PlaneOf<T> made_finer(const PlaneOf<T>& coarse, const detail::GridStep& x,
                      const detail::GridStep& y) {
  PlaneOf<T> finer = make_plane<T>(x.fine, y.fine);
  FramedRow<T> between(x.coarse);
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

template <class T>
double mean_of(const PlaneOf<T>& plane) {
  return std::accumulate(plane.values.begin(), plane.values.end(), 0.0) /
         static_cast<double>(plane.values.size());
}

/// What one term's weights make of the coarser scales and the mean, on the grid of level 1.
template <class T>
PlaneOf<T> sum_of_scales(const CoarseGrids& grids,
                         const std::vector<std::array<PlaneOf<T>, 2>>& scales, const T* weights,
                         T mean) {
  PlaneOf<T> sum = make_plane<T>(scales.back()[0].width, scales.back()[0].height,
                                 weights[2 * scales.size()] * mean);
  for (std::size_t level = scales.size(); level-- > 0;) {
    if (level + 1 < scales.size())
      sum = made_finer(sum, grids.x[level + 1].step, grids.y[level + 1].step);
    for (std::size_t i = 0; i < 2; ++i)
      blur_kernels<T>().add_row(scales[level][i].values.data(), weights[2 * level + i],
                                sum.values.data(), sum.values.size());
  }
  return sum;
}

/// Light times each function of a basis, on the grid of level 1, [term].
template <class T>
std::vector<PlaneOf<T>> coarse_products(const CoarseGrids& grids, const PlaneOf<T>& light,
                                        const TexelBasisOf<T>& basis, std::size_t terms) {
  const detail::GridStep &x = grids.x[0].step, &y = grids.y[0].step;
  std::vector<PlaneOf<T>> sums(terms, make_plane<T>(x.coarse, y.coarse));
  FramedRow<T> products(x.fine);
  std::vector<T> narrow(static_cast<std::size_t>(x.coarse));
  detail::BasisRow<T> functions(basis);
  for (int at = 0; at < y.fine; ++at) {
    functions.move_to(at);
    functions.for_products(row_of(light, at), terms, products, static_cast<std::size_t>(x.fine),
                           [&](std::size_t p, FramedRow<T>& row) {
                             detail::add_coarser_row(row, x, y, at, narrow, sums[p]);
                           });
  }
  return sums;
}

/// Adds to each scale of the coarser grids, [level - 1][scale], what the transpose of sum_of_scales
/// brings there.
/// @return  what it brings to the mean.
template <class T>
double add_to_scales(const CoarseGrids& grids, PlaneOf<T> light, const T* weights,
                     std::vector<std::array<PlaneOf<T>, 2>>& scales) {
  for (std::size_t level = 0; level < scales.size(); ++level) {
    if (level > 0) light = coarsened(light, grids.x[level].step, grids.y[level].step);
    for (std::size_t i = 0; i < 2; ++i)
      blur_kernels<T>().add_row(light.values.data(), weights[2 * level + i],
                                scales[level][i].values.data(), light.values.size());
  }
  return static_cast<double>(weights[2 * scales.size()]) * mean_of(light);
}

/// The transpose of coarse_scales: what the scales bring to the finest grid.
template <class T>
PlaneOf<T> sum_of_blurs(const CoarseGrids& grids,
                        const std::vector<std::array<PlaneOf<T>, 2>>& scales) {
  PlaneOf<T> sum;
  const auto add = [&](const PlaneOf<T>& more) {
    if (sum.values.empty())
      sum = more;
    else
      blur_kernels<T>().add_row(more.values.data(), T(1), sum.values.data(), sum.values.size());
  };
  for (std::size_t level = scales.size(); level-- > 0;) {
    for (std::size_t i = 2; i-- > 0;) {
      add(scales[level][i]);
      sum = blurred(sum, grids.x[level].taps[i], grids.y[level].taps[i], [](int, const T*) {});
    }
    sum = made_finer(sum, grids.x[level].step, grids.y[level].step);
  }
  return sum;
}

/// @param has_slopes  else these stay empty
template <class T>
std::vector<PlaneAndSlope<T>> apply_with_slopes(const BlurPyramid& pyramid, const PlaneOf<T>& input,
                                                const TexelBasisOf<T>& basis,
                                                MappedOperators<T> operators, bool has_slopes) {
  assert(input.width == pyramid.width && input.height == pyramid.height);
  const std::size_t scales = pyramid.variances.size();
  const auto width = static_cast<std::size_t>(pyramid.width);
  std::vector<PlaneAndSlope<T>> results(operators.size());
  for (std::size_t o = 0; o < operators.size(); ++o) {
    results[o].plane = make_plane<T>(pyramid.width, pyramid.height);
    if (has_slopes && operators[o]->terms > 1) results[o].slope = results[o].plane;
  }
  const auto slope_row = [&](std::size_t o, int y) {
    return results[o].slope.values.empty() ? nullptr : row_of(results[o].slope, y);
  };
  std::vector<T> coefficients;
  detail::BasisRow<T> functions(basis);
  const auto add = [&](std::size_t scale, int y, const T* row) {
    functions.move_to(y);
    for (std::size_t o = 0; o < operators.size(); ++o) {
      coefficients.clear();
      for (std::size_t p = 0; p < operators[o]->terms; ++p)
        coefficients.push_back(operators[o]->weights[p * scales + scale]);
      functions.add_times_sum(row, coefficients, row_of(results[o].plane, y), slope_row(o, y),
                              width);
    }
  };
  for (int y = 0; y < input.height; ++y) add(0, y, row_of(input, y));
  PlaneOf<T> last;
  for (std::size_t scale = 1; scale < finest_scales; ++scale) {
    const std::vector<float> taps = finest_taps(scale);
    last = blurred(scale == 1 ? input : last, taps, taps,
                   [&](int y, const T* row) { add(scale, y, row); });
  }

  const CoarseGrids grids = coarse_grids(pyramid);
  const auto coarse = coarse_scales(grids, last);
  const auto mean = static_cast<T>(mean_of(input));
  FramedRow<T> between(grids.x[0].step.coarse);
  for (std::size_t o = 0; o < operators.size(); ++o) {
    std::vector<PlaneOf<T>> sums;
    std::vector<std::vector<T>> finer(operators[o]->terms, std::vector<T>(width));
    std::vector<const T*> rows;
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
      functions.add_products(rows, row_of(results[o].plane, y), slope_row(o, y), width);
    }
  }
  return results;
}

}  // namespace

template <class T>
std::vector<PlaneOf<T>> apply_operators(const BlurPyramid& pyramid, const PlaneOf<T>& input,
                                        const std::type_identity_t<TexelBasisOf<T>>& basis,
                                        std::type_identity_t<MappedOperators<T>> operators) {
  std::vector<PlaneOf<T>> results;
  for (PlaneAndSlope<T>& result : apply_with_slopes(pyramid, input, basis, operators, false))
    results.push_back(std::move(result.plane));
  return results;
}

template <class T>
std::vector<PlaneAndSlope<T>> apply_operators_and_slopes(
    const BlurPyramid& pyramid, const PlaneOf<T>& input,
    const std::type_identity_t<TexelBasisOf<T>>& basis,
    std::type_identity_t<MappedOperators<T>> operators) {
  assert(basis.modes.empty());
  return apply_with_slopes(pyramid, input, basis, operators, true);
}

template <class T>
PlaneOf<T> apply_transposed(const BlurPyramid& pyramid, const std::vector<PlaneOf<T>>& inputs,
                            const std::type_identity_t<TexelBasisOf<T>>& basis,
                            std::type_identity_t<MappedOperators<T>> operators) {
  assert(!inputs.empty() && inputs.size() == operators.size());
  const std::size_t scales = pyramid.variances.size();
  const auto width = static_cast<std::size_t>(pyramid.width);
  const CoarseGrids grids = coarse_grids(pyramid);
  std::vector<std::array<PlaneOf<T>, 2>> coarse;
  for (std::size_t l = 0; l < grids.x.size(); ++l) {
    const auto zero = make_plane<T>(grids.x[l].step.coarse, grids.y[l].step.coarse);
    coarse.push_back({zero, zero});
  }
  double everywhere = 0.0;  // what the widest scale, the mean, brings
  for (std::size_t o = 0; o < operators.size(); ++o) {
    std::vector<PlaneOf<T>> products =
        coarse_products(grids, inputs[o], basis, operators[o]->terms);
    for (std::size_t p = 0; p < products.size(); ++p)
      everywhere += add_to_scales(grids, std::move(products[p]),
                                  &operators[o]->weights[p * scales + finest_scales], coarse);
  }
  std::vector<T> coefficients;
  detail::BasisRow<T> functions(basis);
  const auto add = [&](std::size_t scale, int y, T* row) {
    functions.move_to(y);
    for (std::size_t o = 0; o < operators.size(); ++o) {
      coefficients.clear();
      for (std::size_t p = 0; p < operators[o]->terms; ++p)
        coefficients.push_back(operators[o]->weights[p * scales + scale]);
      functions.add_times_sum(row_of(inputs[o], y), coefficients, row, nullptr, width);
    }
  };
  PlaneOf<T> sum = sum_of_blurs(grids, coarse);
  for (int y = 0; y < pyramid.height; ++y) add(finest_scales - 1, y, row_of(sum, y));
  for (std::size_t scale = finest_scales; --scale > 0;) {
    const std::vector<float> taps = finest_taps(scale);
    sum = blurred(sum, taps, taps, [&](int y, T* row) { add(scale - 1, y, row); });
  }
  for (T& value : sum.values) value += static_cast<T>(everywhere);
  return sum;
}

#define LAMINA_INSTANTIATE(T)                                                                   \
  template std::vector<PlaneAndSlope<T>> apply_operators_and_slopes(                            \
      const BlurPyramid&, const PlaneOf<T>&, const TexelBasisOf<T>&, MappedOperators<T>);       \
  template std::vector<PlaneOf<T>> apply_operators(const BlurPyramid&, const PlaneOf<T>&,       \
                                                   const TexelBasisOf<T>&, MappedOperators<T>); \
  template PlaneOf<T> apply_transposed(const BlurPyramid&, const std::vector<PlaneOf<T>>&,      \
                                       const TexelBasisOf<T>&, MappedOperators<T>)
LAMINA_INSTANTIATE(float);
LAMINA_INSTANTIATE(double);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
