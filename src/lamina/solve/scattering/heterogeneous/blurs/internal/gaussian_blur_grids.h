// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/blurs/gaussian_blurs.h"

// The grids of gaussian_blurs.cpp, each coarser by about two than the one before, and the way
// between them.

namespace lamina::detail {

/// The place that a mirror at both ends shows at i.
[[nodiscard]] int reflected(int i, int size);

/// A side of a grid beside that of a coarser one over the same length, with mirrors at both ends:
/// coarse texels are half as many, rounded up, and so a little narrower than two where the side is
/// odd.
///
/// On its way up light is interpolated linearly between the middles of coarse texels, and each
/// fine texel takes its mean; the way down is the transpose. So both keep the light and leave
/// uniform light uniform, whatever the sizes. Where a coarse texel is two fine ones, the weights
/// are 1 3 3 1 over 4.
struct GridStep {
  int fine, coarse;
  std::vector<std::array<int, 3>> at;       ///< [fine texel] the coarse ones that it is made of
  std::vector<std::array<float, 3>> share;  ///< [fine texel] of each; sum is 1
};

[[nodiscard]] GridStep make_grid_step(int fine);

/// A side of a coarser grid.
struct CoarseSide {
  GridStep step;  ///< from the next finer grid
  /// Taps of what blurs to the grid's first scale and on to its second: whatever the ratios of
  /// sizes, both have their variance.
  std::array<std::vector<float>, 2> taps;
};

/// [level - 1], for a side of the finest grid.
[[nodiscard]] std::vector<CoarseSide> coarse_sides(int side, int levels);

/// Taps e^-t I_n(t) of the discrete Gaussian, to where they fall below 1e-6, with a sum of 1.
[[nodiscard]] std::vector<float> gaussian_taps(double t);

/// Variances on the finest grid, and further ones on a coarser grid in texel² of a grid that is
/// coarser by exactly two per level.
inline constexpr std::array<double, finest_scales> finest_variances = {0.0, 0.25, 0.5,
                                                                       1.0, 2.0,  4.0};
inline constexpr std::array<double, 2> coarse_variances = {2.0, 4.0};

/// Variance that a step to a grid `ratio` times as coarse, or back, adds, in finer texel²:
/// that of the hats plus that of a fine texel.
[[nodiscard]] constexpr double step_variance(double ratio) {
  return ratio * ratio / 6.0 + 1.0 / 12.0;
}

/// A row with a frame to either side, in which it is mirrored.
template <class T>
class FramedRow {
 public:
  explicit FramedRow(int size);
  [[nodiscard]] T* data();
  void mirror();

 private:
  int size_;
  std::vector<T> values_;
};

template <class T>
[[nodiscard]] T* row_of(PlaneOf<T>& plane, int y) {
  return plane.values.data() + static_cast<std::ptrdiff_t>(y) * plane.width;
}
template <class T>
[[nodiscard]] const T* row_of(const PlaneOf<T>& plane, int y) {
  return plane.values.data() + static_cast<std::ptrdiff_t>(y) * plane.width;
}

/// Adds to a plane on the next coarser grid what row `at` of the finer one brings to it.
/// @param row     framed; it is mirrored here
/// @param narrow  of the coarse grid's width
template <class T>
void add_coarser_row(FramedRow<T>& row, const GridStep& x, const GridStep& y, int at,
                     std::vector<T>& narrow, PlaneOf<T>& coarse);

/// A plane on the next coarser grid.
template <class T>
[[nodiscard]] PlaneOf<T> coarsened(const PlaneOf<T>& plane, const GridStep& x, const GridStep& y);

/// Row `at` of the plane on the next finer grid; `between` has the coarse grid's width.
template <class T>
void make_finer_row(const PlaneOf<T>& coarse, const GridStep& x, const GridStep& y, int at,
                    FramedRow<T>& between, T* row);

}  // namespace lamina::detail
