// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/blurs/internal/gaussian_blur_grids.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "lamina/solve/scattering/heterogeneous/blurs/internal/gaussian_blur_kernels.h"

namespace lamina::detail {
namespace {

/// Integral of a hat of half-width 1 around 0, up to u.
double integral_of_hat(double u) {
  u = std::clamp(u, -1.0, 1.0);
  return u < 0.0 ? 0.5 * (1.0 + u) * (1.0 + u) : 1.0 - 0.5 * (1.0 - u) * (1.0 - u);
}

/// A row of the finer grid, `from` framed.
template <class T>
void refine(const T* from, const GridStep& step, T* row) {
  if (step.fine == 2 * step.coarse) {
    blur_kernels<T>().double_row(from, row, static_cast<std::size_t>(step.fine));
    return;
  }
  for (std::size_t x = 0; x < step.at.size(); ++x) {
    T sum = 0;
    for (std::size_t n = 0; n < 3; ++n) sum += step.share[x][n] * from[step.at[x][n]];
    row[x] = sum;
  }
}

/// Its transpose over the ratio of sizes; `from` framed.
template <class T>
void coarsen(const T* from, const GridStep& step, T* row) {
  if (step.fine == 2 * step.coarse) {
    blur_kernels<T>().halve_row(from, row, static_cast<std::size_t>(step.coarse));
    return;
  }
  const T part = static_cast<T>(step.coarse) / static_cast<T>(step.fine);
  std::fill_n(row, step.coarse, T{});
  for (std::size_t x = 0; x < step.at.size(); ++x)
    for (std::size_t n = 0; n < 3; ++n) row[step.at[x][n]] += part * step.share[x][n] * from[x];
}

}  // namespace

int reflected(int i, int size) {
  const int period = 2 * size;
  i = ((i % period) + period) % period;
  return i < size ? i : period - 1 - i;
}

GridStep make_grid_step(int fine) {
  GridStep step{.fine = fine, .coarse = (fine + 1) / 2, .at = {}, .share = {}};
  const double per_texel = static_cast<double>(step.coarse) / fine;  // coarse texels per fine one
  for (int x = 0; x < fine; ++x) {
    const double begin = x * per_texel, end = (x + 1) * per_texel;
    const int first = static_cast<int>(std::floor(begin - 0.5));
    std::array<int, 3>& at = step.at.emplace_back();
    std::array<float, 3>& share = step.share.emplace_back();
    for (int n = 0; n < 3; ++n) {
      const auto i = static_cast<std::size_t>(n);
      const double middle = first + n + 0.5;
      at[i] = reflected(first + n, step.coarse);
      share[i] = static_cast<float>(
          (integral_of_hat(end - middle) - integral_of_hat(begin - middle)) / per_texel);
    }
  }
  return step;
}

std::vector<CoarseSide> coarse_sides(int side, int levels) {
  std::vector<CoarseSide> sides;
  double nominal = 1.0, texel = 1.0;  // variance where grids are coarser by two; a texel's width
  for (int level = 1; level <= levels; ++level) {
    GridStep step = make_grid_step(level == 1 ? side : sides.back().step.coarse);
    const double ratio = static_cast<double>(step.fine) / step.coarse;
    const double before =
        nominal * (level == 1 ? finest_variances.back() : coarse_variances.back());
    const double arrived = before + 2.0 * step_variance(ratio) * texel * texel;
    nominal *= 4.0;
    texel *= ratio;
    const auto blur = [&](double from, double to) {
      return gaussian_taps((to - from) / (texel * texel));
    };
    sides.push_back({.step = std::move(step),
                     .taps = {blur(arrived, coarse_variances[0] * nominal),
                              blur(coarse_variances[0] * nominal, coarse_variances[1] * nominal)}});
  }
  return sides;
}

std::vector<float> gaussian_taps(double t) {
  std::vector<double> taps;
  double sum = 0.0;
  for (std::size_t n = 0; n <= frame; ++n) {
    const double tap = std::exp(-t) * std::cyl_bessel_i(static_cast<double>(n), t);
    if (tap < 1e-6) break;
    taps.push_back(tap);
    sum += n == 0 ? tap : 2.0 * tap;
  }
  std::vector<float> result;
  for (const double tap : taps) result.push_back(static_cast<float>(tap / sum));
  return result;
}

template <class T>
FramedRow<T>::FramedRow(int size)
    : size_(size), values_(static_cast<std::size_t>(size) + 4 * frame) {}

template <class T>
T* FramedRow<T>::data() {
  return values_.data() + 2 * frame;
}

template <class T>
void FramedRow<T>::mirror() {
  T* const row = data();
  constexpr int reach = static_cast<int>(frame);
  for (int i = 1; i <= reach; ++i) {
    const bool is_wide = size_ >= reach;
    row[-i] = row[is_wide ? i - 1 : reflected(-i, size_)];
    row[size_ + i - 1] = row[is_wide ? size_ - i : reflected(size_ + i - 1, size_)];
  }
}

template <class T>
void add_coarser_row(FramedRow<T>& row, const GridStep& x, const GridStep& y, int from,
                     std::vector<T>& narrow, PlaneOf<T>& coarse) {
  const T part = static_cast<T>(y.coarse) / static_cast<T>(y.fine);
  row.mirror();
  coarsen(row.data(), x, narrow.data());
  const auto& at = y.at[static_cast<std::size_t>(from)];
  const auto& share = y.share[static_cast<std::size_t>(from)];
  for (std::size_t n = 0; n < 3; ++n)
    if (share[n] > 0.0f)
      blur_kernels<T>().add_row(narrow.data(), part * share[n], row_of(coarse, at[n]),
                                narrow.size());
}

template <class T>
PlaneOf<T> coarsened(const PlaneOf<T>& plane, const GridStep& x, const GridStep& y) {
  PlaneOf<T> result = make_plane<T>(x.coarse, y.coarse);
  FramedRow<T> row(x.fine);
  std::vector<T> narrow(static_cast<std::size_t>(x.coarse));
  for (int from = 0; from < y.fine; ++from) {
    std::copy_n(row_of(plane, from), x.fine, row.data());
    add_coarser_row(row, x, y, from, narrow, result);
  }
  return result;
}

template <class T>
void make_finer_row(const PlaneOf<T>& coarse, const GridStep& x, const GridStep& y, int at,
                    FramedRow<T>& between, T* row) {
  const auto size = static_cast<std::size_t>(x.coarse);
  const auto& rows = y.at[static_cast<std::size_t>(at)];
  const auto& share = y.share[static_cast<std::size_t>(at)];
  std::fill_n(between.data(), size, T{});
  for (std::size_t n = 0; n < 3; ++n)
    if (share[n] > 0.0f)
      blur_kernels<T>().add_row(row_of(coarse, rows[n]), share[n], between.data(), size);
  between.mirror();
  refine(between.data(), x, row);
}

#define LAMINA_INSTANTIATE(T)                                                            \
  template class FramedRow<T>;                                                           \
  template void add_coarser_row(FramedRow<T>&, const GridStep&, const GridStep&, int,    \
                                std::vector<T>&, PlaneOf<T>&);                           \
  template PlaneOf<T> coarsened(const PlaneOf<T>&, const GridStep&, const GridStep&);    \
  template void make_finer_row(const PlaneOf<T>&, const GridStep&, const GridStep&, int, \
                               FramedRow<T>&, T*)
LAMINA_INSTANTIATE(float);
LAMINA_INSTANTIATE(double);
#undef LAMINA_INSTANTIATE

}  // namespace lamina::detail
